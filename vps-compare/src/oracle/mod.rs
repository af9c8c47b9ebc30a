//! Exact penetrations to compare algorithms with.

mod ball_tree;
mod depth_search;
mod indexed_solid;
mod plane;
mod solid;
mod surface_distance;
mod triangle_distance;

pub use plane::PlaneOracle;
pub use solid::{ExactPenetration, SolidOracle};
