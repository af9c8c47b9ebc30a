//! Voxelmaps: a regular grid, the store of its values, and the surface of the solid.

mod accuracy;
mod error;
mod grid;
pub mod store;
#[cfg(feature = "alloc")]
mod surface_mesh;
mod voxelmap;

pub use self::accuracy::Accuracy;
pub use self::error::VoxelmapError;
pub use self::grid::{Grid, GridError};
#[cfg(feature = "alloc")]
pub use self::surface_mesh::SurfaceMesh;
pub use self::voxelmap::{BEND_STEPS, UNKNOWN_BEND, Voxelmap};
