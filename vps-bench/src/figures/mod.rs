//! Figures of curves, and pictures of solids, without a display and without fonts of the system.

pub(crate) mod axis;
pub(crate) mod figure;
mod font;
pub(crate) mod render;
