//! The font of all figures.

use std::sync::Once;

use plotters::style::{FontStyle, register_font};

pub(super) const FONT: &str = "sans-serif";

/// Registers the bundled font, so that text can be drawn.
pub(super) fn register_fonts() {
    static FONT_REGISTERED: Once = Once::new();
    FONT_REGISTERED.call_once(|| {
        let font = epaint_default_fonts::UBUNTU_LIGHT;
        // The font is a constant of its crate and known to be valid.
        let _ = register_font(FONT, FontStyle::Normal, font);
    });
}
