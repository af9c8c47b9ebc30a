//! The closest point of the surface of a VPS shape.

use rapier3d::math::Vector;
use rapier3d::parry::query::{PointProjection, PointQuery};
use rapier3d::parry::shape::FeatureId;
use vps_core::{Aabb, DistanceField, LANES, Points, Trilinear, Vec3};

use super::VpsShape;
use crate::real::{core_vector, vector};
use crate::surroundings::nearest_of_shell;

/// By how many voxels a point may be further than another one and is as good.
const AS_GOOD: f32 = 0.25;

/// How close to the surface a point on it is, in voxels.
const ON_SURFACE: f32 = 0.01;

/// Newton steps to the surface at most.
const NEWTON_STEPS: usize = 8;

/// Steps along the surface at most.
const SLIDES: usize = 24;

impl PointQuery for VpsShape {
    /// The closest point to within a voxel, however far away.
    fn project_local_point(&self, point: Vector, solid: bool) -> PointProjection {
        let is_inside = self.contains_local_point(point);
        if solid && is_inside || !point.is_finite() {
            return PointProjection::new(is_inside, point);
        }
        let closest = Search::new(self, point).closest();
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
    /// The closest point of the surface.
    pub(crate) fn closest_on_surface(&self, place: Vec3) -> Vec3 {
        Search::new(self, vector(place)).closest()
    }
}

/// Branch and bound: the box of the surface is cut in eight again and again, down to voxels. Parts are
/// left out that have no point closer than the best one by as much as matters, or no surface in them.
struct Search<'s> {
    shape: &'s VpsShape,
    field: Trilinear<'s>,
    size: f32,
    /// Where all of the surface is.
    bounds: Aabb,
    /// Places are taken from here, so that they can be told apart from far away.
    middle: Vec3,
    /// From there to the point that is to be projected.
    to_point: Vec3,
    best: Option<Vec3>,
}

/// A cube that may hold a part of the surface.
struct Part {
    center: Vec3,
    half: f32,
    least: f32,
}

impl<'s> Search<'s> {
    fn new(shape: &'s VpsShape, point: Vector) -> Self {
        let field = shape.asset().voxelmap.trilinear();
        let bounds = shape.surface_bounds();
        let middle = bounds.center();
        Self {
            shape,
            field,
            size: field.voxel_size(),
            bounds,
            middle,
            to_point: core_vector(point - vector(middle)),
            best: None,
        }
    }

    fn closest(mut self) -> Vec3 {
        let point = self.middle + self.to_point;
        // A point of the surface itself, and never far from the closest.
        if let Some(nearest) = nearest_of_shell(self.shape, point) {
            self.offer(nearest);
            self.slide(nearest);
        }
        self.slide(self.bounds.clamp(point));
        if !self.is_closest(point) {
            self.search();
        }
        self.best.unwrap_or(self.middle)
    }

    /// Whether the field itself says that there is nothing closer.
    fn is_closest(&self, point: Vec3) -> bool {
        let map = &self.shape.asset().voxelmap;
        let (depth, accuracy) = (
            self.field.penetration(point, Vec3::ZERO).abs(),
            map.accuracy(),
        );
        // Further away it may be wrong by more than matters.
        depth + 2.0 * self.size <= accuracy.band_m
            && self
                .best
                .is_some_and(|best| best.distance(point) <= depth + AS_GOOD * self.size)
    }

    /// How far a place is, as a number that grows with its distance: the squared distance less that of
    /// the middle.
    fn far(&self, place: Vec3) -> f32 {
        let place = place - self.middle;
        place.length_squared() - 2.0 * place.dot(self.to_point)
    }

    fn offer(&mut self, place: Vec3) {
        if self
            .best
            .is_none_or(|best| self.far(place) < self.far(best))
        {
            self.best = Some(place);
        }
    }

    /// What is no closer than this is no better than the best.
    fn enough(&self) -> f32 {
        self.best.map_or(f32::INFINITY, |best| {
            let by = AS_GOOD * self.size;
            let distance = (self.to_point - (best - self.middle)).length();
            self.far(best) - by * (2.0 * distance - by)
        })
    }

    /// Where the gradient of the field leads from a place, if it leads to the surface.
    fn on_surface(&self, mut place: Vec3) -> Option<Vec3> {
        for _ in 0..NEWTON_STEPS {
            let penetration = self.field.penetration(place, Vec3::ZERO);
            if penetration.abs() < ON_SURFACE * self.size {
                return Some(place);
            }
            place -= self.field.inward_direction(place) * penetration;
        }
        None
    }

    /// From a place to the surface, and along it as long as that comes closer.
    fn slide(&mut self, from: Vec3) {
        let Some(mut place) = self.on_surface(from) else {
            return;
        };
        let mut reach = 4.0 * self.size;
        for _ in 0..SLIDES {
            let normal = self.field.inward_direction(place);
            let way = self.to_point - (place - self.middle);
            let along = (way - normal * way.dot(normal)).clamp_length_max(reach);
            if along.length() < 0.1 * self.size {
                break;
            }
            match self.on_surface(place + along) {
                Some(next) if self.far(next) < self.far(place) => place = next,
                _ => reach = 0.5 * along.length(),
            }
        }
        self.offer(place);
    }

    fn search(&mut self) {
        let longest = self.bounds.extents().max_element();
        let mut half = 0.5 * self.size;
        while 2.0 * half < longest {
            half *= 2.0;
        }
        let all = Part {
            center: self.bounds.min + half,
            half,
            least: f32::NEG_INFINITY,
        };
        let mut parts = vec![all];
        while let Some(part) = parts.pop() {
            if part.least >= self.enough() {
                continue;
            }
            if part.half < self.size {
                self.look_at(&part);
                continue;
            }
            let first = parts.len();
            self.halve(&part, &mut parts);
            // The closest one on top.
            parts[first..].sort_unstable_by(|a, b| b.least.total_cmp(&a.least));
        }
    }

    /// The surface in a part of the size of a voxel.
    fn look_at(&mut self, part: &Part) {
        let point = self.middle + self.to_point;
        let closest = part.bounds().clamp(point);
        if let Some(place) = self.on_surface(closest)
            && self
                .best
                .is_none_or(|best| self.far(place) < self.far(best))
        {
            self.slide(place);
        }
    }

    /// The eighths of a part that may hold something closer than the best.
    fn halve(&self, part: &Part, parts: &mut Vec<Part>) {
        let half = 0.5 * part.half;
        let (enough, radius) = (self.enough(), half * 3.0_f32.sqrt());
        let side = |i: usize, axis: usize| if i >> axis & 1 == 1 { half } else { -half };
        for first in [0, LANES] {
            let mut centers = Points::splat(part.center);
            for lane in 0..LANES {
                centers.x[lane] += side(first + lane, 0);
                centers.y[lane] += side(first + lane, 1);
                centers.z[lane] += side(first + lane, 2);
            }
            let penetrations = self.field.penetrations(&centers, &centers);
            for (lane, penetration) in penetrations.into_iter().enumerate() {
                let center = centers.get(lane);
                let mut eighth = Part {
                    center,
                    half,
                    least: 0.0,
                };
                let bounds = eighth.bounds();
                let is_out = bounds.min.cmpgt(self.bounds.max).any();
                if is_out || self.field.sign_radius(penetration) > radius {
                    continue;
                }
                let closest = bounds.clamp(self.middle + self.to_point);
                eighth.least = self.far(self.bounds.clamp(closest));
                if eighth.least < enough {
                    parts.push(eighth);
                }
            }
        }
    }
}

impl Part {
    fn bounds(&self) -> Aabb {
        Aabb {
            min: self.center - self.half,
            max: self.center + self.half,
        }
    }
}
