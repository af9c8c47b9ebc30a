//! Voxelmaps: a regular grid, the store of its values, and the surface of the solid.

mod error;
mod error_bounds;
mod grid;
pub(crate) mod store;
#[cfg(feature = "alloc")]
mod surface_mesh;
mod voxelmap;

pub use self::error::VoxelmapError;
pub use self::error_bounds::ErrorBounds;
pub use self::grid::{Grid, GridError};
#[cfg(feature = "alloc")]
pub use self::surface_mesh::SurfaceMesh;
pub use self::voxelmap::{CURVATURE_STEPS, CURVATURE_UNKNOWN, Voxelmap, VoxelmapParts};
