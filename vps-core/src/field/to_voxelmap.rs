//! A voxelmap of a distance field.

use alloc::vec::Vec;

use glamx::Vec3;

use crate::field::distance_field::DistanceField;
use crate::map::store::{Store, Values};
use crate::map::{ErrorBounds, Grid, Voxelmap, VoxelmapError, VoxelmapParts};

impl Voxelmap<'static> {
    /// A dense map of a field on a grid, four bytes a voxel: the penetration of each voxel's centre. The
    /// field's [`error_bound`](DistanceField::error_bound) must hold at all centres, as that of the exact
    /// solids does. Costs a penetration a voxel.
    ///
    /// # Errors
    /// When the field's bounds do not lie between the outermost voxel centres of the grid, or a
    /// penetration is not finite.
    ///
    /// ```
    /// use vps_core::{Ball, DistanceField, Grid, Vec3, Voxelmap};
    ///
    /// let grid = Grid::new(Vec3::splat(-0.15), 0.01, [30; 3])?;
    /// let map = Voxelmap::of_field(grid, &Ball::new(0.1))?;
    /// let depth = map.trilinear().penetration(Vec3::X * 0.092, Vec3::NEG_X);
    /// assert!((depth - 0.008).abs() < 1e-3);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn of_field(
        grid: Grid,
        field: &(impl DistanceField + ?Sized),
    ) -> Result<Self, VoxelmapError> {
        let [nx, ny, nz] = grid.dims();
        let rows = (0..nz).flat_map(|z| (0..ny).map(move |y| (y, z)));
        let voxels = rows.flat_map(|(y, z)| (0..nx).map(move |x| [x, y, z]));
        let penetration = |voxel| field.penetration(grid.center(voxel), Vec3::ZERO);
        let values: Vec<_> = voxels.map(penetration).collect();
        let bounds = grid.bounds();
        let farthest = bounds.min.abs().max(bounds.max.abs()).length();
        // Of the coordinates of the centres.
        let rounding = 8.0 * f32::EPSILON * farthest;
        let error = field.error_bound() + rounding;
        Self::from_parts(VoxelmapParts {
            grid,
            sigma: 1.0,
            solid: field.bounds(),
            error_bounds: ErrorBounds {
                in_band: error,
                beyond: error,
                narrow_band: bounds.extents().length(),
            },
            store: Store::dense(grid.dims(), Values::Floats(values.into()))?,
            curvature_bounds: Vec::new().into(),
        })
    }
}
