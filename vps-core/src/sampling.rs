//! The views of a [`Voxelmap`]: what is made of a point between the centres of voxels.

use glamx::Vec3;
use wide::f32x4;

use crate::lanes::{Vectors, Voxels};
use crate::{Aabb, Accuracy, Discs, DistanceField, LANES, Points, Voxelmap};

/// Half the diagonal of a voxel, in voxels.
const HALF_DIAGONAL: f32 = 0.866_025_4;

const SQRT_3: f32 = 1.732_050_8;

/// A [`Voxelmap`] sampled as in eq. 4: V(P) = n·e + vσ with e = C − P.
///
/// One value is read a point. The error is the map's plus at most the diagonal of a voxel, √3 s:
/// the centre C is up to half of it away, and so is the local part n·e. Jumps from voxel to voxel.
#[derive(Clone, Copy, Debug)]
pub struct LocalPenetration<'m>(pub(crate) &'m Voxelmap<'m>);

/// A [`Voxelmap`] sampled as in eq. 5: V(P) = V(C) + ∇V·(P − C) / s, where ∇V is the difference
/// per voxel between the values on both sides of the centre C.
///
/// Seven values are read a point. The error is the map's plus at most half the diagonal of a voxel
/// and three times half an edge, (√3 + 3) s / 2, where the surface is sharp; over a flat part of it
/// the map's alone (up to three times, since it is extrapolated). Jumps from voxel to voxel where
/// the field bends.
#[derive(Clone, Copy, Debug)]
pub struct Linear<'m>(pub(crate) &'m Voxelmap<'m>);

/// A [`Voxelmap`] sampled by trilinear interpolation.
///
/// Eight values are read a point. The error is the map's plus at most half the diagonal of a
/// voxel, √3/2 s; over a flat part of the surface it is the map's alone. Continuous.
#[derive(Clone, Copy, Debug)]
pub struct Trilinear<'m>(pub(crate) &'m Voxelmap<'m>);

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
        let inside = map.grid().bounds().clamp(point);
        let voxel = map.grid().voxel_at(inside);
        let to_center = map.grid().center(voxel) - inside;
        normal.dot(to_center) + map.center_penetration(voxel) - point.distance(inside)
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
        self.0.accuracy().near_m + 2.0 * HALF_DIAGONAL * self.0.grid().voxel_size()
    }
}

impl DistanceField for Linear<'_> {
    #[inline]
    fn penetration(&self, point: Vec3, _normal: Vec3) -> f32 {
        let map = self.0;
        let inside = map.grid().bounds().clamp(point);
        let voxel = map.grid().voxel_at(inside);
        let from_center = (inside - map.grid().center(voxel)) / map.grid().voxel_size();
        let along = gradient(map, voxel).dot(from_center);
        map.center_penetration(voxel) + along - point.distance(inside)
    }

    #[inline]
    fn inward_direction(&self, point: Vec3) -> Vec3 {
        let map = self.0;
        let voxel = map.grid().voxel_at(map.grid().bounds().clamp(point));
        gradient(map, voxel).normalize_or_zero()
    }

    /// Those of the linear function of each point's voxel.
    fn penetrations_and_gradients(
        &self,
        points: &Points,
        normals: &Points,
    ) -> ([f32; LANES], Points) {
        let (map, mut gradients) = (self.0, Points::default());
        for lane in 0..LANES {
            let inside = map.grid().bounds().clamp(points.get(lane));
            let slope = gradient(map, map.grid().voxel_at(inside));
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
        // The value of the centre, and one and a half times the difference of two others.
        4.0 * self.0.accuracy().near_m + (HALF_DIAGONAL + 1.5) * self.0.grid().voxel_size()
    }
}

/// The difference of the penetration per voxel in metres, between the neighbours of a voxel; at the
/// border of the grid between the voxel and its one neighbour.
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

/// An upper bound on what a sampling within so many voxels of the exact penetration can give in
/// the ball.
fn bound_by_voxel(map: &Voxelmap<'_>, center: Vec3, radius: f32, voxels_off: f32) -> f32 {
    let (grid, accuracy) = (map.grid(), map.accuracy());
    let inside = grid.bounds().clamp(center);
    let voxel = grid.voxel_at(inside);
    let stored = map.center_penetration(voxel);
    let error = if stored.abs() > accuracy.band_m {
        accuracy.far_m
    } else {
        accuracy.near_m
    };
    // The exact penetration changes by no more than the way from the voxel's centre; and no point
    // of the solid is closer than its box.
    let by_voxel = stored + error + center.distance(grid.center(voxel));
    let outside = map.solid().distance_outside(center);
    // At the border four times the error of a value is in the sum of eq. 5, and those of its
    // neighbours may be as far from it as three diagonals.
    let reach = 3.0 * SQRT_3 * grid.voxel_size() + 4.0 * accuracy.far_m;
    let at_center = if outside > 0.0 {
        by_voxel.min(-outside)
    } else {
        by_voxel
    };
    let at_most = at_center + radius;
    let exact = f32x4::splat(at_most + voxels_off * grid.voxel_size());
    Stored::new(accuracy, reach)
        .of(exact, f32x4::splat(4.0))
        .to_array()[0]
}

/// From the exact penetration to what is stored and sampled.
struct Stored {
    accuracy: Accuracy,
    /// Sampled values closer to zero are made of near ones alone, in metres.
    near: f32,
}

impl Stored {
    /// `reach` is how far what is sampled may be from any of the values it is made of, in metres.
    #[inline(always)]
    fn new(accuracy: Accuracy, reach: f32) -> Self {
        Self {
            accuracy,
            near: accuracy.band_m - reach,
        }
    }

    /// How far the values may be off that give these.
    #[inline(always)]
    fn error_at(&self, sampled: f32x4) -> f32x4 {
        let is_far = sampled.abs().simd_gt(f32x4::splat(self.near));
        is_far.select(
            f32x4::splat(self.accuracy.far_m),
            f32x4::splat(self.accuracy.near_m),
        )
    }

    /// The most that can be sampled where values without an error would give `exact` at most;
    /// `times` is how much of the error of a value gets into the result.
    #[inline(always)]
    fn of(&self, exact: f32x4, times: f32x4) -> f32x4 {
        let near = exact + times * self.accuracy.near_m;
        let far = exact + times * self.accuracy.far_m;
        // Deep inside values may be far off; so they may far outside, but there they lie below.
        let outside = near.fast_max(far.fast_min(f32x4::splat(-self.near)));
        far.simd_gt(f32x4::splat(self.near)).select(far, outside)
    }
}

impl Trilinear<'_> {
    /// Edge length s of a voxel in metres.
    #[inline]
    pub fn voxel_size(&self) -> f32 {
        self.0.grid().voxel_size()
    }

    /// How far [`penetration`](DistanceField::penetration) at `point` may be from the exact one, in
    /// metres: the error bound of the field close to the surface, more far from it, and twice the
    /// way to the grid more outside of the grid.
    pub fn error_bound_at(&self, point: Vec3) -> f32 {
        let map = self.0;
        let way = map.grid().center_bounds().distance_outside(point);
        // Beyond the band no value around the point may be taken for a near one.
        let reach = 2.0 * HALF_DIAGONAL * map.grid().voxel_size();
        let depth = self.penetration(point, Vec3::ZERO) + way;
        let beyond = if depth.abs() + reach > map.accuracy().band_m {
            map.accuracy().far_m - map.accuracy().near_m
        } else {
            0.0
        };
        self.error_bound() + beyond + 2.0 * way
    }

    /// What is interpolated at the points.
    #[inline(always)]
    fn sampled(&self, points: Vectors) -> Sampled {
        let (grid, store) = (self.0.grid(), self.0.store());
        let inside = points.clamped(&grid.center_bounds());
        let (corners, between) = grid.cells_at(inside);
        let (values, slopes) = store.interpolated(corners, between);
        let sigma = f32x4::splat(self.0.sigma());
        let off = points.minus(inside);
        Sampled {
            values: values * sigma,
            gradients: slopes.times(sigma * grid.per_metre()),
            corners,
            outside: off.length_if_any(),
            off,
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
    /// more than the linear function at the centre gives it and (r² / 2 + √3 r + r²) bends. Outside
    /// of the grid all that holds for the closest points in it; since what is sampled falls with the
    /// way to the grid, the linear function goes on to hold there, unless it falls faster.
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
        let steepest = gradients.length();
        let mut bent = at_center
            + discs.rise(gradients, steepest)
            + (voxels * 1.5 + SQRT_3) * voxels * map.bends_at(sampled.corners);
        let leaves = centers.room_in(&map.grid().center_bounds()).simd_lt(radii);
        let is_in_grid = !leaves.any();
        // The other bounds are no smaller then.
        if is_in_grid && (is_near & bent.simd_le(at_center + radii)).all() {
            return bent;
        }

        let smoothed = (radii * radii + 0.75 * s * s).sqrt();
        let way = smoothed.fast_min(radii * SQRT_3);
        let chance = (radii * (SQRT_3 * map.grid().per_metre())).fast_min(f32x4::ONE);
        let bound = Stored::new(accuracy, SQRT_3 * s + 2.0 * accuracy.far_m);
        let error = bound.error_at(at_center);
        let by_way = bound.of(at_center + way + chance * error, chance);
        if is_in_grid {
            return is_near.select(bent.fast_min(by_way), by_way);
        }
        // Outside of the grid the way to it is taken off, which is shorter by up to a radius.
        let by_way = by_way - (sampled.outside - radii).fast_max(f32x4::ZERO);
        let steeper = (steepest - 1.0).fast_max(f32x4::ZERO);
        bent += gradients.dot(sampled.off) + (leaves & (steeper * (sampled.outside + radii)));
        let out = is_near.select(bent.fast_min(by_way), by_way);
        // No point of the solid is closer than its box.
        let to_box = centers.minus(centers.clamped(&map.solid())).length();
        let by_box = bound.of(radii - to_box + HALF_DIAGONAL * s, f32x4::ONE);
        let is_outside = sampled.outside.simd_gt(f32x4::ZERO);
        is_outside.select(by_box.fast_min(out), out)
    }
}

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
    /// The way from the box in metres.
    off: Vectors,
    /// How long that is.
    outside: f32x4,
}

impl Sampled {
    /// How the penetration grows with the place, per metre. Along an axis on which a point is beyond
    /// the box only the way to the box counts.
    #[inline(always)]
    fn slope(&self) -> Vectors {
        if !self.outside.simd_gt(f32x4::ZERO).any() {
            return self.gradients;
        }
        let slope = |within: f32x4, off: f32x4| {
            let is_within = off.simd_eq(f32x4::ZERO);
            is_within.select(within, -off / self.outside)
        };
        Vectors {
            x: slope(self.gradients.x, self.off.x),
            y: slope(self.gradients.y, self.off.y),
            z: slope(self.gradients.z, self.off.z),
        }
    }
}

impl DistanceField for Trilinear<'_> {
    #[inline]
    fn penetration(&self, point: Vec3, _normal: Vec3) -> f32 {
        let sampled = self.sampled(Vectors::splat(point));
        (sampled.values - sampled.outside).to_array()[0]
    }

    /// By differences of the interpolated field over a voxel on each side.
    #[inline]
    fn inward_direction(&self, point: Vec3) -> Vec3 {
        let map = self.0;
        let point = Points::splat(map.grid().bounds().clamp(point));
        let step = map.grid().voxel_size();
        let (mut after, mut before) = (point, point);
        after.x[0] += step;
        after.y[1] += step;
        after.z[2] += step;
        before.x[0] -= step;
        before.y[1] -= step;
        before.z[2] -= step;
        let [after, before] = [after, before].map(|p| self.penetrations(&p, &p));
        let slope = |axis: usize| after[axis] - before[axis];
        Vec3::new(slope(0), slope(1), slope(2)).normalize_or_zero()
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
        let sampled = self.sampled((*points).into());
        (sampled.values - sampled.outside).to_array()
    }

    /// Those of what is interpolated: the forces along them are the derivative of a potential.
    #[inline(always)]
    fn penetrations_and_gradients(
        &self,
        points: &Points,
        _normals: &Points,
    ) -> ([f32; LANES], Points) {
        let sampled = self.sampled((*points).into());
        let penetrations = sampled.values - sampled.outside;
        (penetrations.to_array(), sampled.slope().into())
    }

    #[inline(always)]
    fn penetration_bounds(&self, discs: &Discs) -> [f32; LANES] {
        self.bounds_of_discs(discs).to_array()
    }
}
