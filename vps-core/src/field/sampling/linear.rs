//! Sampling by the value and the gradient of a voxel (eq. 5).

use glamx::Vec3;

use super::HALF_DIAGONAL;
use super::voxel_bound::bound_by_voxel;
use crate::aabb::Aabb;
use crate::field::distance_field::DistanceField;
use crate::field::extrapolation::{extrapolated_direction, extrapolated_penetration};
use crate::map::Voxelmap;
use crate::simd::{LANES, Points};

/// A [`Voxelmap`] sampled as in eq. 5: V(P) = V(C) + ∇V·(P − C) / s, where ∇V is the difference
/// per voxel between the values on both sides of the centre C.
///
/// Reads seven values a point. Near sharp edges the error is that of the map plus at most half the
/// diagonal of a voxel and three halves of an edge, (√3 + 3) s / 2. Over a planar part of the
/// surface it is that of the map alone, up to three times because of the extrapolation.
/// Discontinuous between voxels where the field is curved.
///
/// ```
/// use vps_core::{Ball, DistanceField, Grid, Vec3, Voxelmap};
///
/// let grid = Grid::new(Vec3::splat(-0.15), 0.01, [30; 3])?;
/// let map = Voxelmap::of_field(grid, &Ball::new(0.1))?;
/// let field = map.linear();
/// let depth = field.penetration(Vec3::X * 0.092, Vec3::NEG_X);
/// assert!((depth - 0.008).abs() <= field.error_bound());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Linear<'m>(&'m Voxelmap<'m>);

impl Voxelmap<'_> {
    /// The map sampled as in eq. 5: the value of the voxel plus its gradient times the offset
    /// from its centre.
    #[inline]
    pub fn linear(&self) -> Linear<'_> {
        Linear(self)
    }
}

impl DistanceField for Linear<'_> {
    #[inline]
    fn penetration(&self, point: Vec3, _normal: Vec3) -> f32 {
        let map = self.0;
        let clamped = map.grid().bounds().clamp(point);
        let voxel = map.grid().voxel_at(clamped);
        let from_center = (clamped - map.grid().center(voxel)) / map.grid().voxel_size();
        let at_clamped = map.center_penetration(voxel) + gradient(map, voxel).dot(from_center);
        extrapolated_penetration(point, clamped, &map.solid(), at_clamped)
    }

    #[inline]
    fn inward_direction(&self, point: Vec3) -> Vec3 {
        let map = self.0;
        let clamped = map.grid().bounds().clamp(point);
        let voxel = map.grid().voxel_at(clamped);
        let direction = gradient(map, voxel).normalize_or_zero();
        let at_clamped = map.center_penetration(voxel);
        extrapolated_direction(point, clamped, &map.solid(), at_clamped, direction)
    }

    /// The gradients are those of the linear function of each point's voxel.
    fn penetrations_and_gradients(
        &self,
        points: &Points,
        normals: &Points,
    ) -> ([f32; LANES], Points) {
        let (map, mut gradients) = (self.0, Points::default());
        for lane in 0..LANES {
            let clamped = map.grid().bounds().clamp(points.get(lane));
            let slope = gradient(map, map.grid().voxel_at(clamped));
            gradients.set(lane, slope / map.grid().voxel_size());
        }
        (self.penetrations(points, normals), gradients)
    }

    #[inline]
    fn penetration_bound(&self, center: Vec3, radius: f32) -> f32 {
        bound_by_voxel(self.0, center, radius, HALF_DIAGONAL + 1.5)
    }

    #[inline]
    fn bounds(&self) -> Aabb {
        self.0.solid()
    }

    #[inline]
    fn error_bound(&self) -> f32 {
        // The error of the value at the centre, and three halves of that of a difference of two
        // values.
        4.0 * self.0.error_bounds().in_band + (HALF_DIAGONAL + 1.5) * self.0.grid().voxel_size()
    }
}

/// The gradient by central differences in metres per voxel; one-sided at the border of the grid.
fn gradient(map: &Voxelmap<'_>, voxel: [u32; 3]) -> Vec3 {
    let dims = map.grid().dims();
    let slope = |axis: usize| {
        let mut next = [voxel; 2];
        next[0][axis] = voxel[axis].saturating_sub(1);
        next[1][axis] = (voxel[axis] + 1).min(dims[axis] - 1);
        let steps = next[1][axis] - next[0][axis];
        let [before, after] = next.map(|v| map.center_penetration(v));
        (after - before) / steps.max(1) as f32
    };
    Vec3::new(slope(0), slope(1), slope(2))
}
