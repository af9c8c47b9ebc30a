//! Trilinear interpolation.

use glamx::Vec3;
use wide::f32x4;

use super::error_model::ErrorModel;
use super::{HALF_DIAGONAL, SQRT_3};
use crate::aabb::Aabb;
use crate::field::discs::Discs;
use crate::field::distance_field::DistanceField;
use crate::field::extrapolation::{Extrapolation, extrapolated_direction};
use crate::field::grid_border::{GridBorder, LinearBound};
use crate::map::{Grid, Voxelmap};
use crate::simd::{LANES, Points, Vectors, Voxels};

/// A [`Voxelmap`] sampled by trilinear interpolation.
///
/// Reads eight values a point. The error is that of the map plus at most half the diagonal of a voxel,
/// √3/2 s; over a planar part of the surface it is that of the map alone. Continuous.
///
/// ```
/// use vps_core::{Ball, DistanceField, Grid, Vec3, Voxelmap};
///
/// let grid = Grid::new(Vec3::splat(-0.15), 0.01, [30; 3])?;
/// let map = Voxelmap::of_field(grid, &Ball::new(0.1))?;
/// let field = map.trilinear();
/// let depth = field.penetration(Vec3::X * 0.092, Vec3::NEG_X);
/// assert!((depth - 0.008).abs() <= field.error_bound());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Trilinear<'m>(&'m Voxelmap<'m>);

impl Voxelmap<'_> {
    /// The map sampled by trilinear interpolation of the eight values around a point: continuous
    /// from voxel to voxel, and independent of the normal.
    #[inline]
    pub fn trilinear(&self) -> Trilinear<'_> {
        Trilinear(self)
    }
}

impl Trilinear<'_> {
    /// Edge length s of a voxel in metres.
    #[inline]
    pub fn voxel_size(&self) -> f32 {
        self.0.grid().voxel_size()
    }

    /// The grid of the map.
    #[inline]
    pub fn grid(&self) -> &Grid {
        self.0.grid()
    }

    /// Radius in metres around a point in the grid within which the field keeps its sign, given the
    /// penetration at the point. Over a distance r the interpolated field changes by at most
    /// √(r² + 3/4 s²) and the errors of values. 0 where nothing is known.
    pub fn sign_radius(&self, penetration: f32) -> f32 {
        let s = self.voxel_size();
        // Where the field changes its sign, all values around are in the narrow band.
        let error = self.value_error(penetration) + self.value_error(0.0);
        let change = (penetration.abs() - error).max(0.0);
        let square = (change * change - 0.75 * s * s).max(0.0);
        f32x4::splat(square).sqrt().to_array()[0]
    }

    /// The largest error of [`penetration`](DistanceField::penetration) at `point`, in metres.
    /// Within the grid it is the [`overestimate_bound_at`](Self::overestimate_bound_at). Outside,
    /// where distances may be underestimated, it is larger by the detour through the closest point
    /// of the grid.
    pub fn error_bound_at(&self, point: Vec3) -> f32 {
        let to_grid = self.0.grid().center_bounds().distance_outside(point);
        let sampled = self.sampled(Vectors::splat(point));
        let at_clamped = -sampled.values.to_array()[0];
        let distance = self.signed_distance(point);
        let underestimate = if to_grid > 0.0 {
            to_grid + at_clamped.max(0.0) - distance
        } else {
            0.0
        };
        self.overestimate_bound_at(point) + underestimate
    }

    /// The most by which the [signed distance](DistanceField::signed_distance) at `point` exceeds
    /// the exact one, in metres. It is the [error bound](DistanceField::error_bound) of the field
    /// close to the surface. Beyond the narrow band it includes the larger error of values
    /// ([`ErrorBounds::beyond`](crate::ErrorBounds::beyond)). Outside of the grid it is that of the
    /// closest point of the grid.
    pub fn overestimate_bound_at(&self, point: Vec3) -> f32 {
        let sampled = self.sampled(Vectors::splat(point)).values.to_array()[0];
        HALF_DIAGONAL * self.voxel_size() + self.value_error(sampled)
    }

    /// The largest error of the values around a point, given the interpolated value.
    fn value_error(&self, interpolated: f32) -> f32 {
        let error_bounds = self.0.error_bounds();
        // A value interpolated from one beyond the narrow band is no closer to zero than this.
        let reach = SQRT_3 * self.voxel_size() + error_bounds.beyond + error_bounds.in_band;
        if interpolated.abs() + reach <= error_bounds.narrow_band {
            error_bounds.in_band
        } else {
            error_bounds.beyond
        }
    }

    /// Interpolates at the closest points of the grid.
    #[inline(always)]
    fn sampled(&self, points: Vectors) -> Sampled {
        let (grid, store) = (self.0.grid(), self.0.store());
        let clamped = points.clamped(&grid.center_bounds());
        let (corners, fractions) = grid.cells_at(clamped);
        let (values, slopes) = store.interpolated(corners, fractions);
        let sigma = f32x4::splat(self.0.sigma());
        Sampled {
            values: values * sigma,
            gradients: slopes.times(sigma * grid.per_metre()),
            corners,
            clamped,
            offset: points.minus(clamped),
        }
    }

    /// Penetrations at the points.
    #[inline(always)]
    fn penetrations_at(&self, points: Vectors) -> f32x4 {
        self.extrapolated(&self.sampled(points))
    }

    /// Penetrations at the points of a sample, within the grid and outside.
    #[inline(always)]
    fn extrapolated(&self, sampled: &Sampled) -> f32x4 {
        let is_outside = sampled.is_outside();
        if is_outside.any() {
            let extrapolation =
                Extrapolation::new(sampled.clamped, sampled.offset, &self.0.solid());
            is_outside.select(extrapolation.penetrations(sampled.values), sampled.values)
        } else {
            sampled.values
        }
    }

    /// Upper bounds for discs, the smallest of up to three.
    ///
    /// The first is a Lipschitz bound: the exact penetration changes by at most the distance. The
    /// interpolated value at a point is the average of the values around it, with weights for which
    /// the average of their positions is the point, as if each coordinate were rounded up or down
    /// at random. If the coordinates of two points a distance r apart are rounded by the same
    /// random numbers, the two positions differ on average by at most √3 r, and by at most √(r² +
    /// 3/4 s²), since along each axis their difference takes one of two values s apart around that
    /// of the points. Errors of values count only where the positions differ, with a probability of
    /// at most √3 r / s.
    ///
    /// The second is a curvature bound: the disc is thin, and the map bounds its second
    /// differences. Along the line from the centre to a point r voxels away, the slope changes at
    /// each face between voxels by at most the bound B, at no more than r + 1 faces along each
    /// axis, and between faces by the twist of the squares. In total the point exceeds the linear
    /// function at the centre by at most (r² / 2 + √3 r + r²) B. [`GridBorder`] continues it
    /// outside of the grid.
    ///
    /// The third is for points outside of the grid. The sampled value there is at most that at the
    /// closest point of the grid, so the first bound holds; [`Extrapolation::bounds`] accounts for
    /// the decrease with the distance. Since no point of the solid is closer than its box, the
    /// sampled value is also bounded by the distance from the box, up to its error: at the closest
    /// point of the grid, and outside as well, because the distance from the box grows as fast
    /// there.
    #[inline(always)]
    fn bounds_of_discs(&self, discs: &Discs) -> f32x4 {
        let map = self.0;
        let (s, error_bounds) = (map.grid().voxel_size(), map.error_bounds());
        let centers = Vectors::from(discs.centers);
        let radii = f32x4::new(discs.radii);
        let sampled = self.sampled(centers);
        let at_center = sampled.values;

        let voxels = radii * map.grid().per_metre();
        let is_in_reach = voxels.simd_le(f32x4::splat(CURVATURE_REACH));
        let gradients = sampled.gradients;
        let excess = (voxels * 1.5 + SQRT_3) * voxels * map.curvature_bounds_at(sampled.corners);
        let grid = map.grid().center_bounds();
        let is_in_grid = centers.depth_in(&grid).simd_ge(radii).all();
        let mut curvature_bound = f32x4::splat(f32::INFINITY);
        let mut is_known = is_in_reach;
        if is_in_grid {
            let bound = at_center + discs.rise(gradients, gradients.length()) + excess;
            curvature_bound = is_known.select(bound, curvature_bound);
            // The other bounds are no smaller in this case.
            if curvature_bound.simd_le(at_center + radii).all() {
                return curvature_bound;
            }
        } else if is_known.any() {
            let linear = LinearBound {
                value: at_center,
                gradient: gradients,
                excess,
            };
            let border = GridBorder::new(discs, sampled.clamped, &grid, &map.solid());
            is_known &= border.straddles_at_most_one_axis();
            curvature_bound = is_known.select(border.bounds(discs, &linear), curvature_bound);
        }

        let smoothed = (radii * radii + 0.75 * s * s).sqrt();
        let change = smoothed.fast_min(radii * SQRT_3);
        let probability = (radii * (SQRT_3 * map.grid().per_metre())).fast_min(f32x4::ONE);
        let errors = ErrorModel::new(error_bounds, SQRT_3 * s + 2.0 * error_bounds.beyond);
        let error = errors.error_at(at_center);
        let lipschitz_bound =
            errors.upper_bound(at_center + change + probability * error, probability);
        let bound = curvature_bound.fast_min(lipschitz_bound);
        // The bounds that remain are for large pieces outside of the grid.
        if is_in_grid || is_known.all() {
            return bound;
        }
        let is_outside = sampled.is_outside();
        if !is_outside.any() {
            return bound;
        }
        let extrapolation = Extrapolation::new(sampled.clamped, sampled.offset, &map.solid());
        // The interpolated value changes by at most the distance and these terms.
        let at_clamped = at_center + error + (MAX_SMOOTHING * s + error_bounds.beyond);
        let exterior_bound = extrapolation.bounds(at_clamped, radii);
        let to_box = centers.minus(centers.clamped(&map.solid())).length();
        let box_bound = errors.upper_bound(radii - to_box + HALF_DIAGONAL * s, f32x4::ONE);
        is_outside.select(exterior_bound.fast_min(box_bound).fast_min(bound), bound)
    }
}

/// The most by which the smaller of √(r² + 3/4 s²) and √3 r exceeds r, in voxels.
const MAX_SMOOTHING: f32 = 0.448_3;

/// Distance from a cell, in voxels, up to which its curvature bound holds.
const CURVATURE_REACH: f32 = 7.0;

/// The field interpolated at points clamped to the box between the outermost voxel centres.
struct Sampled {
    /// Penetrations in metres.
    values: f32x4,
    /// Gradients of the penetrations, per metre.
    gradients: Vectors,
    /// The lowest of the eight voxels around each point.
    corners: Voxels,
    /// The clamped points, in metres.
    clamped: Vectors,
    /// From the clamped points to the original ones, in metres.
    offset: Vectors,
}

impl Sampled {
    /// The lanes whose points are outside of the grid.
    #[inline(always)]
    fn is_outside(&self) -> f32x4 {
        self.offset.dot(self.offset).simd_gt(f32x4::ZERO)
    }
}

impl DistanceField for Trilinear<'_> {
    #[inline]
    fn penetration(&self, point: Vec3, _normal: Vec3) -> f32 {
        self.penetrations_at(Vectors::splat(point)).to_array()[0]
    }

    /// By central differences of the interpolated field over a voxel on each side.
    #[inline]
    fn inward_direction(&self, point: Vec3) -> Vec3 {
        let map = self.0;
        let clamped = map.grid().bounds().clamp(point);
        let step = map.grid().voxel_size();
        let (mut after, mut before) = (Points::splat(clamped), Points::splat(clamped));
        after.x[0] += step;
        after.y[1] += step;
        after.z[2] += step;
        before.x[0] -= step;
        before.y[1] -= step;
        before.z[2] -= step;
        let [after, before] = [after, before].map(|p| self.penetrations(&p, &p));
        let slope = |axis: usize| after[axis] - before[axis];
        let direction = Vec3::new(slope(0), slope(1), slope(2)).normalize_or_zero();
        if clamped == point {
            return direction;
        }
        let at_clamped = self.penetration(clamped, Vec3::ZERO);
        extrapolated_direction(point, clamped, &map.solid(), at_clamped, direction)
    }

    #[inline]
    fn penetration_bound(&self, center: Vec3, radius: f32) -> f32 {
        let ball = Discs::balls(&Points::splat(center), [radius; LANES]);
        self.bounds_of_discs(&ball).to_array()[0]
    }

    #[inline]
    fn bounds(&self) -> Aabb {
        self.0.solid()
    }

    #[inline]
    fn error_bound(&self) -> f32 {
        self.0.error_bounds().in_band + HALF_DIAGONAL * self.0.grid().voxel_size()
    }

    #[inline(always)]
    fn penetrations(&self, points: &Points, _normals: &Points) -> [f32; LANES] {
        self.penetrations_at((*points).into()).to_array()
    }

    /// The gradients are those of the interpolated field, so forces along them derive from a
    /// potential.
    #[inline(always)]
    fn penetrations_and_gradients(
        &self,
        points: &Points,
        _normals: &Points,
    ) -> ([f32; LANES], Points) {
        let sampled = self.sampled((*points).into());
        let is_outside = sampled.is_outside();
        if !is_outside.any() {
            return (sampled.values.to_array(), sampled.gradients.into());
        }
        let extrapolation = Extrapolation::new(sampled.clamped, sampled.offset, &self.0.solid());
        let penetrations = extrapolation.penetrations(sampled.values);
        let gradients = extrapolation.gradients(sampled.values, sampled.gradients);
        let chosen = |outside: f32x4, inside: f32x4| is_outside.select(outside, inside);
        let gradients = Vectors {
            x: chosen(gradients.x, sampled.gradients.x),
            y: chosen(gradients.y, sampled.gradients.y),
            z: chosen(gradients.z, sampled.gradients.z),
        };
        (
            chosen(penetrations, sampled.values).to_array(),
            gradients.into(),
        )
    }

    #[inline(always)]
    fn penetration_bounds(&self, discs: &Discs) -> [f32; LANES] {
        self.bounds_of_discs(discs).to_array()
    }
}
