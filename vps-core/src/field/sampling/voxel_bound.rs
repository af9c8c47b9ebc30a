//! Upper bounds from the value of a single voxel.

use glamx::Vec3;
use wide::f32x4;

use super::SQRT_3;
use super::error_model::ErrorModel;
use crate::field::extrapolation::Extrapolation;
use crate::map::Voxelmap;
use crate::simd::Vectors;

/// An upper bound in a ball for a sampling that deviates by at most `max_deviation` voxels from the
/// exact penetration, apart from the error of the values.
pub(super) fn bound_by_voxel(
    map: &Voxelmap<'_>,
    center: Vec3,
    radius: f32,
    max_deviation: f32,
) -> f32 {
    let (grid, error_bounds) = (map.grid(), map.error_bounds());
    let clamped = grid.bounds().clamp(center);
    let voxel = grid.voxel_at(clamped);
    let stored = map.center_penetration(voxel);
    let error = if stored.abs() > error_bounds.narrow_band {
        error_bounds.beyond
    } else {
        error_bounds.in_band
    };
    let deviation = max_deviation * grid.voxel_size();
    // The exact penetration changes by at most the distance from the voxel's centre; outside of the
    // grid it is no higher than at the closest point of the grid.
    let exact = stored + error + clamped.distance(grid.center(voxel));
    // At the border the sum of eq. 5 contains four times the error of a value, and its neighbours may
    // differ by three diagonals.
    let reach = 3.0 * SQRT_3 * grid.voxel_size() + 4.0 * error_bounds.beyond;
    let errors = ErrorModel::new(error_bounds, reach);
    let upper_bound = |exact: f32| errors.upper_bound(f32x4::splat(exact), f32x4::splat(4.0));
    let lipschitz_bound = upper_bound(exact + radius + deviation);
    if clamped == center {
        return lipschitz_bound.to_array()[0];
    }
    // No point of the solid is closer than its box.
    let box_bound = upper_bound(radius - map.solid().distance_outside(center) + deviation);
    let extrapolation = Extrapolation::new(
        Vectors::splat(clamped),
        Vectors::splat(center - clamped),
        &map.solid(),
    );
    let at_clamped = f32x4::splat(exact + deviation + 4.0 * error_bounds.beyond);
    let exterior_bound = extrapolation.bounds(at_clamped, f32x4::splat(radius));
    lipschitz_bound
        .fast_min(box_bound)
        .fast_min(exterior_bound)
        .to_array()[0]
}
