//! Upper bounds from the value of a single voxel.

use glamx::Vec3;
use wide::f32x4;

use super::SQRT_3;
use super::error_model::Stored;
use crate::field::extrapolation::Beyond;
use crate::map::Voxelmap;
use crate::simd::Vectors;

/// An upper bound on what a sampling within so many voxels of the exact penetration can give in
/// the ball.
pub(super) fn bound_by_voxel(
    map: &Voxelmap<'_>,
    center: Vec3,
    radius: f32,
    voxels_off: f32,
) -> f32 {
    let (grid, accuracy) = (map.grid(), map.accuracy());
    let inside = grid.bounds().clamp(center);
    let voxel = grid.voxel_at(inside);
    let stored = map.center_penetration(voxel);
    let error = if stored.abs() > accuracy.band_m {
        accuracy.far_m
    } else {
        accuracy.near_m
    };
    let sampled_off = voxels_off * grid.voxel_size();
    // The exact penetration changes by no more than the way from the voxel's centre; that at the
    // closest points of the grid is no lower than outside.
    let by_voxel = stored + error + inside.distance(grid.center(voxel));
    // At the border four times the error of a value is in the sum of eq. 5, and those of its
    // neighbours may be as far from it as three diagonals.
    let reach = 3.0 * SQRT_3 * grid.voxel_size() + 4.0 * accuracy.far_m;
    let stored = Stored::new(accuracy, reach);
    let of = |exact: f32| stored.of(f32x4::splat(exact), f32x4::splat(4.0));
    let by_way = of(by_voxel + radius + sampled_off);
    if inside == center {
        return by_way.to_array()[0];
    }
    // No point of the solid is closer than its box.
    let by_box = of(radius - map.solid().distance_outside(center) + sampled_off);
    let beyond = Beyond::new(
        Vectors::splat(inside),
        Vectors::splat(center - inside),
        &map.solid(),
    );
    let at_border = f32x4::splat(by_voxel + sampled_off + 4.0 * accuracy.far_m);
    let by_border = beyond.bounds(at_border, f32x4::splat(radius));
    by_way.fast_min(by_box).fast_min(by_border).to_array()[0]
}
