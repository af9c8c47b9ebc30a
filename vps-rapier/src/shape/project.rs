//! Projection of points on the surface of a VPS shape.

use rapier3d::math::Vector;
use rapier3d::parry::query::{PointProjection, PointQuery};
use rapier3d::parry::shape::FeatureId;
use vps_core::raw::{LANES, Points};
use vps_core::{Aabb, Ball, DistanceField, Pose3, Query, Trilinear, Vec3};

use super::VpsShape;
use crate::precision::{core_vector, vector};

/// Distance in voxels by which a projection may be further away than the closest point.
const TOLERANCE: f32 = 0.25;

/// Distance from the surface in voxels up to which a point counts as on it.
const ON_SURFACE: f32 = 0.01;

/// Most Newton steps to the surface.
const MAX_NEWTON_STEPS: usize = 8;

/// Most steps along the surface.
const MAX_SLIDES: usize = 24;

impl PointQuery for VpsShape {
    /// The closest point to within a voxel, however far away.
    fn project_local_point(&self, point: Vector, solid: bool) -> PointProjection {
        let is_inside = self.contains_local_point(point);
        if solid && is_inside || !point.is_finite() {
            return PointProjection::new(is_inside, point);
        }
        let closest = Projection::new(self, point).closest();
        PointProjection::new(is_inside, vector(closest))
    }

    fn project_local_point_and_get_feature(&self, point: Vector) -> (PointProjection, FeatureId) {
        (self.project_local_point(point, false), FeatureId::Unknown)
    }

    fn contains_local_point(&self, point: Vector) -> bool {
        let field = self.asset().voxelmap.trilinear();
        field.penetration(core_vector(point), Vec3::ZERO) > 0.0
    }
}

impl VpsShape {
    /// The closest point of the surface, to within a voxel.
    pub(crate) fn closest_on_surface(&self, point: Vec3) -> Vec3 {
        Projection::new(self, vector(point)).closest()
    }

    /// The closest point of the shell; `None` for a point that is not finite.
    pub(crate) fn nearest_of_shell(&self, point: Vec3) -> Option<Vec3> {
        let origin = Ball::new(f32::MIN_POSITIVE);
        let pose = Pose3::from_translation(-point);
        let query = Query::new(&self.asset().tree, &origin, pose);
        query.closest().map(|contact| contact.position)
    }
}

/// The search for the closest point of the surface. Points of the shell and Newton steps along the
/// gradient give a candidate. Unless the field shows that it is the closest, branch and bound divides
/// the box of the surface into octants down to voxels, and leaves out those without a zero of the
/// field, and those without a point that is closer than the candidate by more than [`TOLERANCE`].
struct Projection<'s> {
    shape: &'s VpsShape,
    field: Trilinear<'s>,
    voxel_size: f32,
    /// A box that holds the whole surface.
    bounds: Aabb,
    /// Distances are computed relative to here, so that rounding does not hide their differences when
    /// the point is far away.
    middle: Vec3,
    /// From `middle` to the point to project.
    to_point: Vec3,
    best: Option<Vec3>,
}

/// A cube that may hold a part of the surface.
struct Octant {
    center: Vec3,
    half: f32,
    /// Lower bound of the relative squared distance of its points.
    lower_bound: f32,
}

impl<'s> Projection<'s> {
    fn new(shape: &'s VpsShape, point: Vector) -> Self {
        let field = shape.asset().voxelmap.trilinear();
        let bounds = shape.surface_bounds();
        let middle = bounds.center();
        Self {
            shape,
            field,
            voxel_size: field.voxel_size(),
            bounds,
            middle,
            to_point: core_vector(point - vector(middle)),
            best: None,
        }
    }

    fn closest(mut self) -> Vec3 {
        let point = self.middle + self.to_point;
        // A point of the shell lies on the surface, and never far from the closest point.
        if let Some(nearest) = self.shape.nearest_of_shell(point) {
            self.add(nearest);
            self.slide(nearest);
        }
        self.slide(self.bounds.clamp(point));
        if !self.is_closest(point) {
            self.search();
        }
        self.best.unwrap_or(self.middle)
    }

    /// Whether the field shows that no point of the surface is closer than the best.
    fn is_closest(&self, point: Vec3) -> bool {
        let map = &self.shape.asset().voxelmap;
        let (depth, error_bounds) = (
            self.field.penetration(point, Vec3::ZERO).abs(),
            map.error_bounds(),
        );
        // Beyond the narrow band the error of the field exceeds the tolerance.
        depth + 2.0 * self.voxel_size <= error_bounds.narrow_band
            && self
                .best
                .is_some_and(|best| best.distance(point) <= depth + TOLERANCE * self.voxel_size)
    }

    /// The squared distance of a candidate from the point, less that of the middle.
    fn relative_squared(&self, candidate: Vec3) -> f32 {
        let offset = candidate - self.middle;
        offset.length_squared() - 2.0 * offset.dot(self.to_point)
    }

    fn is_closer(&self, candidate: Vec3) -> bool {
        self.best
            .is_none_or(|best| self.relative_squared(candidate) < self.relative_squared(best))
    }

    fn add(&mut self, candidate: Vec3) {
        if self.is_closer(candidate) {
            self.best = Some(candidate);
        }
    }

    /// Candidates with a relative squared distance of at least this do not improve on the best by more
    /// than the tolerance.
    fn threshold(&self) -> f32 {
        self.best.map_or(f32::INFINITY, |best| {
            let tolerance = TOLERANCE * self.voxel_size;
            let distance = (self.to_point - (best - self.middle)).length();
            self.relative_squared(best) - tolerance * (2.0 * distance - tolerance)
        })
    }

    /// The point of the surface that Newton steps along the gradient lead to, if they converge.
    fn on_surface(&self, mut point: Vec3) -> Option<Vec3> {
        for _ in 0..MAX_NEWTON_STEPS {
            let penetration = self.field.penetration(point, Vec3::ZERO);
            if penetration.abs() < ON_SURFACE * self.voxel_size {
                return Some(point);
            }
            point -= self.field.inward_direction(point) * penetration;
        }
        None
    }

    /// Descends from a point to the surface, and along it as long as that reduces the distance.
    fn slide(&mut self, from: Vec3) {
        let Some(mut current) = self.on_surface(from) else {
            return;
        };
        let mut reach = 4.0 * self.voxel_size;
        for _ in 0..MAX_SLIDES {
            let normal = self.field.inward_direction(current);
            let to_point = self.to_point - (current - self.middle);
            let tangent = to_point - normal * to_point.dot(normal);
            let along = tangent.clamp_length_max(reach);
            if along.length() < 0.1 * self.voxel_size {
                break;
            }
            match self.on_surface(current + along) {
                Some(next) if self.relative_squared(next) < self.relative_squared(current) => {
                    current = next;
                }
                _ => reach = 0.5 * along.length(),
            }
        }
        self.add(current);
    }

    /// Branch and bound over octants.
    fn search(&mut self) {
        let longest = self.bounds.extents().max_element();
        let mut half = 0.5 * self.voxel_size;
        while 2.0 * half < longest {
            half *= 2.0;
        }
        let all = Octant {
            center: self.bounds.min + half,
            half,
            lower_bound: f32::NEG_INFINITY,
        };
        let mut stack = vec![all];
        while let Some(octant) = stack.pop() {
            if octant.lower_bound >= self.threshold() {
                continue;
            }
            if octant.half < self.voxel_size {
                self.refine(&octant);
                continue;
            }
            let first = stack.len();
            self.subdivide(&octant, &mut stack);
            // The closest octant goes on top.
            stack[first..].sort_unstable_by(|a, b| b.lower_bound.total_cmp(&a.lower_bound));
        }
    }

    /// Adds the surface in an octant of the size of a voxel.
    fn refine(&mut self, octant: &Octant) {
        let point = self.middle + self.to_point;
        let closest = octant.bounds().clamp(point);
        if let Some(candidate) = self.on_surface(closest)
            && self.is_closer(candidate)
        {
            self.slide(candidate);
        }
    }

    /// Pushes the octants of an octant that may hold a point closer than the threshold.
    fn subdivide(&self, octant: &Octant, stack: &mut Vec<Octant>) {
        let half = 0.5 * octant.half;
        let (threshold, radius) = (self.threshold(), half * 3.0_f32.sqrt());
        let side = |i: usize, axis: usize| if i >> axis & 1 == 1 { half } else { -half };
        for first in [0, LANES] {
            let mut centers = Points::splat(octant.center);
            for lane in 0..LANES {
                centers.x[lane] += side(first + lane, 0);
                centers.y[lane] += side(first + lane, 1);
                centers.z[lane] += side(first + lane, 2);
            }
            let penetrations = self.field.penetrations(&centers, &centers);
            for (lane, penetration) in penetrations.into_iter().enumerate() {
                let center = centers.get(lane);
                let mut child = Octant {
                    center,
                    half,
                    lower_bound: 0.0,
                };
                let bounds = child.bounds();
                let is_out = bounds.min.cmpgt(self.bounds.max).any();
                if is_out || self.field.sign_radius(penetration) > radius {
                    continue;
                }
                let closest = bounds.clamp(self.middle + self.to_point);
                child.lower_bound = self.relative_squared(self.bounds.clamp(closest));
                if child.lower_bound < threshold {
                    stack.push(child);
                }
            }
        }
    }
}

impl Octant {
    fn bounds(&self) -> Aabb {
        Aabb {
            min: self.center - self.half,
            max: self.center + self.half,
        }
    }
}
