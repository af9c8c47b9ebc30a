//! How deep a body really is.

mod balls;
mod plane;
mod solids;
mod triangles;

pub use plane::PlaneOracle;
pub use solids::{Exact, SolidOracle};
