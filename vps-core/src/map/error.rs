//! Why a voxelmap is refused.

use crate::aabb::Aabb;
use crate::map::error_bounds::ErrorBounds;

/// Why a [`Voxelmap`](crate::Voxelmap) was refused.
///
/// ```
/// use vps_core::{Ball, Grid, Vec3, Voxelmap, VoxelmapError};
///
/// // The ball is as large as the grid.
/// let grid = Grid::new(Vec3::splat(-0.1), 0.02, [10; 3])?;
/// let refused = Voxelmap::of_field(grid, &Ball::new(0.1));
/// assert!(matches!(refused, Err(VoxelmapError::Solid(_))));
/// # Ok::<(), vps_core::GridError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum VoxelmapError {
    /// The number of values does not match the dimensions of a dense store, or the cells of a
    /// sparse one.
    #[error("{values} values in a store that needs {expected}")]
    ValueCount {
        /// Values given.
        values: usize,
        /// Values needed.
        expected: usize,
    },
    /// Interpolation needs two voxels along each axis.
    #[error("a map needs two voxels along each axis, not {0:?}")]
    Thin([u32; 3]),
    /// The cells of a sparse store are inconsistent.
    #[error("the cells of the sparse store do not fit together")]
    Cells,
    /// A value is not finite.
    #[error("a stored distance is not finite")]
    NotFinite,
    /// Store and grid have different dimensions.
    #[error("values for {store:?} voxels on a grid of {grid:?}")]
    Dims {
        /// Voxels along each axis of the store.
        store: [u32; 3],
        /// And of the grid.
        grid: [u32; 3],
    },
    /// The number of curvature bounds is neither 0 nor that of the cells.
    #[error("{bounds} curvature bounds for {cells} cells of voxels")]
    CurvatureBounds {
        /// Curvature bounds given.
        bounds: usize,
        /// Curvature bounds needed.
        cells: usize,
    },
    /// σ is invalid.
    #[error("the value of one step must be positive and finite, not {0} m")]
    Sigma(f32),
    /// An error bound is invalid.
    #[error(
        "error bounds must be finite and not negative, nor smaller beyond the narrow band: {0:?}"
    )]
    ErrorBounds(ErrorBounds),
    /// The solid leaves the box between the outermost voxel centres.
    #[error("the solid {0:?} does not lie between the outermost voxel centres of the grid")]
    Solid(Aabb),
}
