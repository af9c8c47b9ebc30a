//! Trilinear interpolation.

use glamx::Vec3;
use wide::f32x4;

use super::error_model::Stored;
use super::{HALF_DIAGONAL, SQRT_3};
use crate::aabb::Aabb;
use crate::field::discs::Discs;
use crate::field::distance_field::DistanceField;
use crate::field::extrapolation::{Beyond, direction_beyond};
use crate::field::grid_border::{Border, Tangent};
use crate::map::{Grid, Voxelmap};
use crate::simd::{LANES, Points, Vectors, Voxels};

/// A [`Voxelmap`] sampled by trilinear interpolation.
///
/// Eight values are read a point. The error is the map's plus at most half the diagonal of a
/// voxel, √3/2 s; over a flat part of the surface it is the map's alone. Continuous.
#[derive(Clone, Copy, Debug)]
pub struct Trilinear<'m>(pub(crate) &'m Voxelmap<'m>);

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

    /// How far around a point in the grid, given its penetration, the field has the same sign, in
    /// metres: what is interpolated nowhere changes by more than √(r² + 3/4 s²) over a distance r, and
    /// by the errors of values; 0 where that says nothing.
    pub fn sign_radius(&self, penetration: f32) -> f32 {
        let s = self.voxel_size();
        // Around a place where it changes sign all values are near ones.
        let error = self.value_error(penetration) + self.value_error(0.0);
        let change = (penetration.abs() - error).max(0.0);
        let square = (change * change - 0.75 * s * s).max(0.0);
        f32x4::splat(square).sqrt().to_array()[0]
    }

    /// How far [`penetration`](DistanceField::penetration) at `point` may be from the exact one, in
    /// metres. Within the grid that is the
    /// [`overestimate_bound_at`](Self::overestimate_bound_at) there; outside of it, where distances may
    /// be told too short, it is more by what the way through the closest point of the grid is longer.
    pub fn error_bound_at(&self, point: Vec3) -> f32 {
        let way = self.0.grid().center_bounds().distance_outside(point);
        let sampled = self.sampled(Vectors::splat(point));
        let at_border = -sampled.values.to_array()[0];
        let distance = self.signed_distance(point);
        let short = if way > 0.0 {
            way + at_border.max(0.0) - distance
        } else {
            0.0
        };
        self.overestimate_bound_at(point) + short
    }

    /// How much further away than it is the solid may seem to be at `point`, in metres: the
    /// [signed distance](DistanceField::signed_distance) is more than the exact one by no more than
    /// this, anywhere. It is the [error bound](DistanceField::error_bound) of the field close to the
    /// surface, and what values may be off more ([`Accuracy::far_m`](crate::Accuracy::far_m)) beyond the narrow band; outside
    /// of the grid that of the closest point in it.
    pub fn overestimate_bound_at(&self, point: Vec3) -> f32 {
        let sampled = self.sampled(Vectors::splat(point)).values.to_array()[0];
        HALF_DIAGONAL * self.voxel_size() + self.value_error(sampled)
    }

    /// How far the values may be off that something is interpolated from.
    fn value_error(&self, interpolated: f32) -> f32 {
        let accuracy = self.0.accuracy();
        // With one value beyond the band, what is made of it is no closer to zero than this.
        let reach = SQRT_3 * self.voxel_size() + accuracy.far_m + accuracy.near_m;
        if interpolated.abs() + reach <= accuracy.band_m {
            accuracy.near_m
        } else {
            accuracy.far_m
        }
    }

    /// What is interpolated at the points.
    #[inline(always)]
    fn sampled(&self, points: Vectors) -> Sampled {
        let (grid, store) = (self.0.grid(), self.0.store());
        let inside = points.clamped(&grid.center_bounds());
        let (corners, between) = grid.cells_at(inside);
        let (values, slopes) = store.interpolated(corners, between);
        let sigma = f32x4::splat(self.0.sigma());
        Sampled {
            values: values * sigma,
            gradients: slopes.times(sigma * grid.per_metre()),
            corners,
            inside,
            way: points.minus(inside),
        }
    }

    /// Penetrations at the points.
    #[inline(always)]
    fn penetrations_at(&self, points: Vectors) -> f32x4 {
        self.beyond(&self.sampled(points))
    }

    /// Penetrations at the points something was interpolated for, in the grid and beyond.
    #[inline(always)]
    fn beyond(&self, sampled: &Sampled) -> f32x4 {
        let is_outside = sampled.way.dot(sampled.way).simd_gt(f32x4::ZERO);
        if is_outside.any() {
            let beyond = Beyond::new(sampled.inside, sampled.way, &self.0.solid());
            is_outside.select(beyond.penetrations(sampled.values), sampled.values)
        } else {
            sampled.values
        }
    }

    /// Bounds of discs, the smallest of up to three.
    ///
    /// The first needs nothing but that the exact penetration changes no faster than the place.
    /// What is interpolated at a point is the average of the values around it, weighted so that
    /// the average of their places is the point: as if each coordinate were rounded up or down at
    /// random. Round those of two points a distance r apart by the same dice, and on average the
    /// two places differ by no more than √3 r, nor than the square root of r² + 3/4 s² (their
    /// difference takes, along each axis, one of two values s apart around the points' own). The
    /// errors of values count only where the places differ, with a chance of at most √3 r / s.
    ///
    /// The second uses that the disc is flat and that the map knows how much it bends. On the
    /// straight way from the centre to a point r voxels away, the slope changes at each face
    /// between voxels by no more than the bend, and there are no more than r / s + 1 of them along
    /// an axis; between faces it changes by the twist of the squares. Together the point has no
    /// more than the linear function at the centre gives it and (r² / 2 + √3 r + r²) bends. How that
    /// goes on outside of the grid, [`Border`] tells.
    ///
    /// The third is for what lies outside of the grid. There what is sampled is no more than at the
    /// closest point of the grid, so the first holds; see [`Beyond::bounds`] for how it falls. And as
    /// no point of the solid is closer than its box, nor is what is sampled, but for its error: at the
    /// closest point of the grid, and further on since the distance of the box grows as fast there.
    #[inline(always)]
    fn bounds_of_discs(&self, discs: &Discs) -> f32x4 {
        let map = self.0;
        let (s, accuracy) = (map.grid().voxel_size(), map.accuracy());
        let centers = Vectors::from(discs.centers);
        let radii = f32x4::new(discs.radii);
        let sampled = self.sampled(centers);
        let at_center = sampled.values;

        let voxels = radii * map.grid().per_metre();
        let is_near = voxels.simd_le(f32x4::splat(MOST_VOXELS));
        let gradients = sampled.gradients;
        let excess = (voxels * 1.5 + SQRT_3) * voxels * map.bends_at(sampled.corners);
        let grid = map.grid().center_bounds();
        let is_in_grid = centers.room_in(&grid).simd_ge(radii).all();
        let (bent, is_bent_known, at_point) = if is_in_grid {
            let bent = at_center + discs.rise(gradients, gradients.length()) + excess;
            (bent, is_near, at_center)
        } else {
            let tangent = Tangent {
                value: at_center,
                gradient: gradients,
                excess,
            };
            let border = Border::new(discs, sampled.inside, &grid, &map.solid());
            let bent = border.bounds(discs, &tangent);
            (bent, is_near & border.is_simple(), self.beyond(&sampled))
        };
        // The other bounds are no smaller then.
        if (is_bent_known & bent.simd_le(at_point + radii)).all() {
            return bent;
        }

        let smoothed = (radii * radii + 0.75 * s * s).sqrt();
        let way = smoothed.fast_min(radii * SQRT_3);
        let chance = (radii * (SQRT_3 * map.grid().per_metre())).fast_min(f32x4::ONE);
        let bound = Stored::new(accuracy, SQRT_3 * s + 2.0 * accuracy.far_m);
        let error = bound.error_at(at_center);
        let by_way = bound.of(at_center + way + chance * error, chance);
        let out = is_bent_known.select(bent.fast_min(by_way), by_way);
        if is_in_grid {
            return out;
        }
        let beyond = Beyond::new(sampled.inside, sampled.way, &map.solid());
        let is_outside = beyond.is_outside();
        if !is_outside.any() {
            return out;
        }
        // What is interpolated changes by no more than the way and this.
        let at_border = at_center + error + (MOST_SMOOTHED * s + accuracy.far_m);
        let by_border = beyond.bounds(at_border, radii);
        let to_box = centers.minus(centers.clamped(&map.solid())).length();
        let by_box = bound.of(radii - to_box + HALF_DIAGONAL * s, f32x4::ONE);
        is_outside.select(by_border.fast_min(by_box).fast_min(out), out)
    }
}

/// The most by which the smaller of √(r² + 3/4 s²) and √3 r is more than r, in voxels.
const MOST_SMOOTHED: f32 = 0.448_3;

/// Up to how many voxels from a cell its bend is known.
const MOST_VOXELS: f32 = 7.0;

/// A field interpolated at the points of the box between the outermost centres that are closest to
/// those asked for.
struct Sampled {
    /// Penetrations in metres.
    values: f32x4,
    /// And their gradients, per metre.
    gradients: Vectors,
    /// The lowest of the voxels around.
    corners: Voxels,
    /// Where these points are.
    inside: Vectors,
    /// From there to those asked for, in metres.
    way: Vectors,
}

impl DistanceField for Trilinear<'_> {
    #[inline]
    fn penetration(&self, point: Vec3, _normal: Vec3) -> f32 {
        self.penetrations_at(Vectors::splat(point)).to_array()[0]
    }

    /// By differences of the interpolated field over a voxel on each side.
    #[inline]
    fn inward_direction(&self, point: Vec3) -> Vec3 {
        let map = self.0;
        let inside = map.grid().bounds().clamp(point);
        let step = map.grid().voxel_size();
        let (mut after, mut before) = (Points::splat(inside), Points::splat(inside));
        after.x[0] += step;
        after.y[1] += step;
        after.z[2] += step;
        before.x[0] -= step;
        before.y[1] -= step;
        before.z[2] -= step;
        let [after, before] = [after, before].map(|p| self.penetrations(&p, &p));
        let slope = |axis: usize| after[axis] - before[axis];
        let direction = Vec3::new(slope(0), slope(1), slope(2)).normalize_or_zero();
        if inside == point {
            return direction;
        }
        let at_border = self.penetration(inside, Vec3::ZERO);
        direction_beyond(point, inside, &map.solid(), at_border, direction)
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
        self.0.accuracy().near_m + HALF_DIAGONAL * self.0.grid().voxel_size()
    }

    #[inline(always)]
    fn penetrations(&self, points: &Points, _normals: &Points) -> [f32; LANES] {
        self.penetrations_at((*points).into()).to_array()
    }

    /// Those of what is interpolated: the forces along them are the derivative of a potential.
    #[inline(always)]
    fn penetrations_and_gradients(
        &self,
        points: &Points,
        _normals: &Points,
    ) -> ([f32; LANES], Points) {
        let sampled = self.sampled((*points).into());
        let is_outside = sampled.way.dot(sampled.way).simd_gt(f32x4::ZERO);
        if !is_outside.any() {
            return (sampled.values.to_array(), sampled.gradients.into());
        }
        let beyond = Beyond::new(sampled.inside, sampled.way, &self.0.solid());
        let penetrations = beyond.penetrations(sampled.values);
        let gradients = beyond.gradients(sampled.values, sampled.gradients);
        let chosen = |beyond: f32x4, within: f32x4| is_outside.select(beyond, within);
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
