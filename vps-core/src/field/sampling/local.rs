//! Sampling by the value of a voxel and the local penetration in it (eq. 4).

use glamx::Vec3;

use super::HALF_DIAGONAL;
use super::voxel_bound::bound_by_voxel;
use crate::aabb::Aabb;
use crate::field::distance_field::DistanceField;
use crate::field::extrapolation::extrapolated_penetration;
use crate::map::Voxelmap;

/// A [`Voxelmap`] sampled as in eq. 4: V(P) = n·e + vσ with e = C − P.
///
/// Reads one value a point. The error is that of the map plus at most the diagonal of a voxel, √3
/// s: half of it by the distance to the centre C, half of it by the local part n·e. Discontinuous
/// between voxels.
///
/// ```
/// use vps_core::{Ball, DistanceField, Grid, Vec3, Voxelmap};
///
/// let grid = Grid::new(Vec3::splat(-0.15), 0.01, [30; 3])?;
/// let map = Voxelmap::of_field(grid, &Ball::new(0.1))?;
/// let field = map.local();
/// let depth = field.penetration(Vec3::X * 0.092, Vec3::NEG_X);
/// assert!((depth - 0.008).abs() <= field.error_bound());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct LocalPenetration<'m>(&'m Voxelmap<'m>);

impl Voxelmap<'_> {
    /// The map sampled as in eq. 4: the value of the voxel plus the depth within the voxel along
    /// the normal of the shell point.
    #[inline]
    pub fn local(&self) -> LocalPenetration<'_> {
        LocalPenetration(self)
    }
}

impl LocalPenetration<'_> {
    /// Edge length s of a voxel in metres.
    #[inline]
    pub fn voxel_size(&self) -> f32 {
        self.0.grid().voxel_size()
    }
}

impl DistanceField for LocalPenetration<'_> {
    #[inline]
    fn penetration(&self, point: Vec3, normal: Vec3) -> f32 {
        let map = self.0;
        let clamped = map.grid().bounds().clamp(point);
        let voxel = map.grid().voxel_at(clamped);
        let to_center = map.grid().center(voxel) - clamped;
        let at_clamped = normal.dot(to_center) + map.center_penetration(voxel);
        extrapolated_penetration(point, clamped, &map.solid(), at_clamped)
    }

    #[inline]
    fn inward_direction(&self, point: Vec3) -> Vec3 {
        self.0.trilinear().inward_direction(point)
    }

    #[inline]
    fn penetration_bound(&self, center: Vec3, radius: f32) -> f32 {
        bound_by_voxel(self.0, center, radius, 2.0 * HALF_DIAGONAL)
    }

    #[inline]
    fn bounds(&self) -> Aabb {
        self.0.solid()
    }

    #[inline]
    fn error_bound(&self) -> f32 {
        self.0.error_bounds().in_band + 2.0 * HALF_DIAGONAL * self.0.grid().voxel_size()
    }
}
