//! Pictures of solids, points and spheres, drawn without a display: a small renderer with a depth
//! buffer, seen from far away (orthographic).

mod canvas;
pub(crate) mod colors;
mod palette;
mod sheet;
mod view;

pub(crate) use canvas::Canvas;
pub(crate) use colors::Color;
pub(crate) use sheet::{Anchor, Sheet};
pub(crate) use view::View;

/// Pixels of a canvas along a pixel of the picture.
pub(crate) const FINE: u32 = 2;
