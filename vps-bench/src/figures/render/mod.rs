//! Pictures of solids, points and spheres: a small orthographic renderer with a depth buffer.

pub(crate) mod canvas;
pub(crate) mod colors;
pub(crate) mod figure_sheet;
mod palette;
pub(crate) mod view;
