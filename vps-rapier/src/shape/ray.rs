//! Rays cast at a VPS shape.

use rapier3d::math::{Real, Vector};
use rapier3d::parry::query::{Ray, RayCast, RayIntersection};
use rapier3d::parry::shape::FeatureId;
use vps_core::raw::{LANES, Points};
use vps_core::{Aabb, DistanceField, Trilinear, Vec3};

use super::VpsShape;
use crate::precision::{core_real, core_vector, real, vector};

/// Most bisections of the piece of a ray in a cell to find where it crosses the surface.
const MAX_BISECTIONS: u32 = 12;

impl RayCast for VpsShape {
    /// The first point at which the interpolated field changes its sign along the ray. It is found
    /// exactly: no wall in the field is passed, however thin it is. A ray from inside, unless `solid`,
    /// hits where it leaves. The normal is out of the side the ray comes from, against the ray.
    fn cast_local_ray_and_get_normal(
        &self,
        ray: &Ray,
        max_time_of_impact: Real,
        solid: bool,
    ) -> Option<RayIntersection> {
        if !(ray.origin.is_finite() && ray.dir.is_finite()) {
            return None;
        }
        let field = self.asset().voxelmap.trilinear();
        let origin = core_vector(ray.origin);
        let starts_inside = field.penetration(origin, Vec3::ZERO) > 0.0;
        if starts_inside && solid {
            let outward = vector(-field.inward_direction(origin));
            return Some(RayIntersection::new(0.0, outward, FeatureId::Unknown));
        }
        let (direction, speed) = direction_and_speed(ray.dir)?;
        let [enter, leave] = clip_ray(ray, &self.surface_bounds(), max_time_of_impact)?;
        let path = Path {
            field,
            start: core_vector(ray.point_at(enter)),
            direction,
            side: if starts_inside { -1.0 } else { 1.0 },
        };
        let distance = path.first_crossing(core_real((leave - enter) * speed))?;
        let time = (enter + real(distance) / speed).min(max_time_of_impact);
        let normal = vector(path.normal(distance));
        Some(RayIntersection::new(time, normal, FeatureId::Unknown))
    }
}

/// The unit direction and the length of a vector, however short or long; `None` if it is zero.
fn direction_and_speed(velocity: Vector) -> Option<(Vec3, Real)> {
    let largest = velocity.abs().max_element();
    if largest == 0.0 {
        return None;
    }
    let scaled = velocity / largest;
    let length = scaled.length();
    Some((core_vector(scaled / length), largest * length))
}

/// The times at which the ray enters and leaves a box, up to `end`; `None` if it misses the box.
fn clip_ray(ray: &Ray, bounds: &Aabb, end: Real) -> Option<[Real; 2]> {
    let (low, high) = (vector(bounds.min), vector(bounds.max));
    let (mut enter, mut leave): (Real, Real) = (0.0, end);
    for axis in 0..3 {
        let (at, speed) = (ray.origin[axis], ray.dir[axis]);
        if speed == 0.0 {
            if at < low[axis] || at > high[axis] {
                return None;
            }
            continue;
        }
        let (one, other) = ((low[axis] - at) / speed, (high[axis] - at) / speed);
        enter = enter.max(one.min(other));
        leave = leave.min(one.max(other));
    }
    (enter <= leave).then_some([enter, leave])
}

/// A straight path through the field, in metres.
struct Path<'m> {
    field: Trilinear<'m>,
    start: Vec3,
    direction: Vec3,
    /// 1 for a path that starts outside, -1 for one that starts inside.
    side: f32,
}

impl Path<'_> {
    /// The distance along the path at which the field first changes its sign, up to `length`.
    fn first_crossing(&self, length: f32) -> Option<f32> {
        let size = self.field.voxel_size();
        let mut distance = 0.0;
        while distance <= length {
            let at = self.start + self.direction * distance;
            let penetration = self.field.penetration(at, Vec3::ZERO);
            let free = self.field.sign_radius(penetration);
            if free > size {
                distance += free;
                continue;
            }
            // In a cell of eight voxel centres the field is a cubic along the path.
            let least = (1e-3 * size).max(4.0 * f32::EPSILON * (at.abs().max_element() + distance));
            let piece = self.to_next_cell(at).max(least);
            let crossing = first_root(self.controls(at, piece), MAX_BISECTIONS);
            if let Some(part) = crossing {
                let crossing = distance + part * piece;
                return (crossing <= length).then_some(crossing);
            }
            distance += piece;
        }
        None
    }

    /// Distance along the path to the next plane of voxel centres.
    fn to_next_cell(&self, at: Vec3) -> f32 {
        let grid = self.field.grid();
        let cells = (at - grid.origin()) / grid.voxel_size() - 0.5;
        let along = |axis: usize| {
            let (cell, speed) = (cells[axis], self.direction[axis]);
            let next = if speed > 0.0 {
                cell.floor() + 1.0
            } else {
                cell.ceil() - 1.0
            };
            let steps = (next - cell) / speed;
            if speed == 0.0 { f32::INFINITY } else { steps }
        };
        along(0).min(along(1)).min(along(2)) * grid.voxel_size()
    }

    /// The control values of the field along a piece of the path, as a cubic in Bernstein form; positive
    /// beyond the surface.
    fn controls(&self, at: Vec3, piece: f32) -> [f32; LANES] {
        let mut points = Points::splat(at);
        for lane in 0..LANES {
            let on_path = at + self.direction * (piece * lane as f32 / 3.0);
            (points.x[lane], points.y[lane], points.z[lane]) = on_path.into();
        }
        let [a, b, c, d] = self.field.penetrations(&points, &points);
        let inner =
            |a: f32, b: f32, c: f32, d: f32| (2.0 * d - 5.0 * a + 9.0 * (b + (b - c))) / 6.0;
        [a, inner(a, b, c, d), inner(d, c, b, a), d].map(|v| v * self.side)
    }

    /// The normal out of the surface, against the path, by central differences over a voxel in front of
    /// it.
    fn normal(&self, distance: f32) -> Vec3 {
        let half = 0.5 * self.field.voxel_size();
        let before = self.start + self.direction * (distance - half);
        let [mut high, mut low] = [Points::splat(before); 2];
        high.x[0] += half;
        high.y[1] += half;
        high.z[2] += half;
        low.x[0] -= half;
        low.y[1] -= half;
        low.z[2] -= half;
        let [high, low] = [high, low].map(|p| self.field.penetrations(&p, &p));
        let rise = Vec3::new(high[0] - low[0], high[1] - low[1], high[2] - low[2]) * self.side;
        match rise.try_normalize() {
            Some(rise) if rise.dot(self.direction) > 0.0 => -rise,
            _ => -self.direction,
        }
    }
}

/// Where in its piece, 0 to 1, a cubic in Bernstein form is first not negative. It is nowhere higher
/// than the highest of its control values.
fn first_root([a, b, c, d]: [f32; 4], bisections: u32) -> Option<f32> {
    if a >= 0.0 {
        return Some(0.0);
    }
    if b < 0.0 && c < 0.0 && d < 0.0 {
        return None;
    }
    if bisections == 0 {
        return (d >= 0.0).then_some(1.0);
    }
    let middle = |a: f32, b: f32| 0.5 * (a + b);
    let (ab, bc, cd) = (middle(a, b), middle(b, c), middle(c, d));
    let (abc, bcd) = (middle(ab, bc), middle(bc, cd));
    let half = middle(abc, bcd);
    let first = first_root([a, ab, abc, half], bisections - 1).map(|t| 0.5 * t);
    first.or_else(|| first_root([half, bcd, cd, d], bisections - 1).map(|t| 0.5 + 0.5 * t))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cubic(controls: [f32; 4], t: f32) -> f32 {
        let [a, b, c, d] = controls;
        let u = 1.0 - t;
        u * u * u * a + 3.0 * u * u * t * b + 3.0 * u * t * t * c + t * t * t * d
    }

    #[test]
    fn roots_of_cubics_are_the_first_ones() {
        let mut state = 1_u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / (1 << 23) as f32 - 1.0
        };
        for _ in 0..2000 {
            let controls = [-random().abs() - 1e-3, random(), random(), random()];
            let mut steps = (0..=4096).map(|i| i as f32 / 4096.0);
            let first = steps.find(|&t| cubic(controls, t) >= 0.0);
            match (first_root(controls, MAX_BISECTIONS), first) {
                (found, Some(first)) => assert!((found.unwrap() - first).abs() < 1e-3),
                (Some(found), None) => assert!(cubic(controls, found) > -1e-3),
                (None, None) => {}
            }
        }
    }
}
