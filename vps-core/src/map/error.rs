//! Why a voxelmap is refused.

use crate::aabb::Aabb;
use crate::map::accuracy::Accuracy;

/// Why a [`Voxelmap`](crate::Voxelmap) was refused.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum VoxelmapError {
    /// Each voxel of a dense store needs a value, a sparse one what its cells say.
    #[error("{values} values in a store that needs {expected}")]
    ValueCount {
        /// Values given.
        values: usize,
        /// Values needed.
        expected: usize,
    },
    /// Between voxels is interpolated.
    #[error("a map needs two voxels along each axis, not {0:?}")]
    Thin([u32; 3]),
    /// The cells of a sparse store are not counted right.
    #[error("the cells of the sparse store do not fit together")]
    Cells,
    /// A value is no number.
    #[error("a stored distance is not finite")]
    NotFinite,
    /// The store is for another grid.
    #[error("values for {store:?} voxels on a grid of {grid:?}")]
    Dims {
        /// Voxels along each axis of the store.
        store: [u32; 3],
        /// And of the grid.
        grid: [u32; 3],
    },
    /// Each cell has a bend, or none has.
    #[error("{bends} bends for {cells} cells of voxels")]
    Bends {
        /// Bends given.
        bends: usize,
        /// Bends needed.
        cells: usize,
    },
    /// σ means nothing.
    #[error("the value of one step must be positive and finite, not {0} m")]
    Sigma(f32),
    /// An error bound means nothing.
    #[error("error bounds must be finite and not negative, near not above far: {0:?}")]
    Accuracy(Accuracy),
    /// The solid must lie where values are interpolated.
    #[error("the solid {0:?} does not lie between the outermost voxel centres of the grid")]
    Solid(Aabb),
}
