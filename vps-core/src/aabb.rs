//! Axis-aligned boxes.

use glamx::{Mat3, Pose3, Vec3};

/// An axis-aligned box, its corners in metres in the frame of the bounded object.
///
/// ```
/// use vps_core::{Aabb, Vec3};
///
/// let unit = Aabb { min: Vec3::ZERO, max: Vec3::ONE };
/// assert!(unit.contains(Vec3::splat(0.5)));
/// assert_eq!(unit.distance_outside(Vec3::new(0.5, 0.5, 1.25)), 0.25);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// The corner with the smallest coordinates.
    pub min: Vec3,
    /// The corner with the largest coordinates.
    pub max: Vec3,
}

impl Aabb {
    /// The smallest box around `points`; `None` without a point.
    pub fn of_points(points: impl IntoIterator<Item = Vec3>) -> Option<Self> {
        let mut points = points.into_iter();
        let first = points.next()?;
        let start = Self {
            min: first,
            max: first,
        };
        Some(points.fold(start, |b, p| Self {
            min: b.min.min(p),
            max: b.max.max(p),
        }))
    }

    /// The point of the box closest to `point`.
    #[inline]
    pub fn clamp(&self, point: Vec3) -> Vec3 {
        point.max(self.min).min(self.max)
    }

    /// Whether `point` lies in the box or on its surface.
    #[inline]
    pub fn contains(&self, point: Vec3) -> bool {
        point.cmpge(self.min).all() && point.cmple(self.max).all()
    }

    /// Whether a body may lie within this box, given the smallest box around it in its own frame;
    /// `to_this` transforms coordinates of that frame to those of this box.
    ///
    /// Never false for a body that does lie within: it touches all six faces of its box, so along any
    /// direction it extends at least as far as the nearest corner of the furthest face.
    pub fn may_contain(&self, body: &Self, to_this: &Pose3) -> bool {
        let half = body.extents() * 0.5;
        let center = to_this.transform_point(body.center());
        let axes = Mat3::from_quat(to_this.rotation);
        let x = axes.x_axis.abs() * half.x;
        let y = axes.y_axis.abs() * half.y;
        let z = axes.z_axis.abs() * half.z;
        let reach = x.max(y).max(z) * 2.0 - (x + y + z);
        (center - reach).cmpge(self.min).all() && (center + reach).cmple(self.max).all()
    }

    /// Distance in metres from `point` to the box, 0 inside it.
    #[inline]
    pub fn distance_outside(&self, point: Vec3) -> f32 {
        point.distance(self.clamp(point))
    }

    /// The middle of the box.
    #[inline]
    pub fn center(&self) -> Vec3 {
        (self.min + self.max) * 0.5
    }

    /// Edge lengths in metres.
    #[inline]
    pub fn extents(&self) -> Vec3 {
        self.max - self.min
    }
}

#[cfg(test)]
mod tests {
    use glamx::Quat;

    use super::*;

    #[test]
    fn bodies_within_a_box_are_never_refused() {
        let bounds = Aabb {
            min: Vec3::new(-1.0, -2.0, -0.5),
            max: Vec3::new(1.0, 1.0, 0.5),
        };
        let mut state = 1_u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / (1 << 23) as f32 - 1.0
        };
        let (mut within, mut refused) = (0, 0);
        for _ in 0..4000 {
            let turn = Quat::from_scaled_axis(Vec3::new(random(), random(), random()) * 3.0);
            let at = Vec3::new(random(), 2.0 * random(), 0.5 * random());
            let pose = Pose3::from_parts(at, turn);
            let points: [Vec3; 5] =
                core::array::from_fn(|_| Vec3::new(random(), random(), random()) * 0.6);
            let body = Aabb::of_points(points).unwrap();
            let is_within = points
                .iter()
                .all(|&p| bounds.contains(pose.transform_point(p)));
            let may = bounds.may_contain(&body, &pose);
            assert!(may || !is_within);
            within += i32::from(is_within);
            refused += i32::from(!may);
        }
        assert!(within > 100 && refused > 100, "{within} {refused}");
    }
}
