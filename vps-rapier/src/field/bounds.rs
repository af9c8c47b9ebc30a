//! Axis-aligned boxes of shapes, and segments clipped to them.

use rapier3d::parry::shape::Shape;
use vps_core::{Aabb, Pose3, Vec3};

use crate::precision::core_vector;

/// The box of a shape, in its own frame.
pub(crate) fn shape_bounds(shape: &dyn Shape) -> Aabb {
    let aabb = shape.compute_local_aabb();
    Aabb {
        min: core_vector(aabb.mins),
        max: core_vector(aabb.maxs),
    }
}

/// A box that encloses a box in another frame; `pose` takes the frame of `bounds` to that frame.
pub(crate) fn transformed(bounds: &Aabb, pose: &Pose3) -> Aabb {
    let reach = rotated_half_extents(pose, 0.5 * bounds.extents());
    let center = pose.transform_point(bounds.center());
    Aabb {
        min: center - reach,
        max: center + reach,
    }
}

/// Half extents of the box that encloses a rotated box with the half extents `half`.
pub(crate) fn rotated_half_extents(pose: &Pose3, half: Vec3) -> Vec3 {
    let axes = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| (pose.rotation * axis).abs());
    axes[0] * half.x + axes[1] * half.y + axes[2] * half.z
}

/// Distance of two boxes along the axis on which they are furthest apart; negative if they overlap.
pub(crate) fn gap(a: &Aabb, b: &Aabb) -> f32 {
    (a.min - b.max).max(b.min - a.max).max_element()
}

/// The part of a segment, 0 to 1, that lies in a box; `None` if it misses the box.
pub(crate) fn clip_segment(start: Vec3, displacement: Vec3, bounds: &Aabb) -> Option<[f32; 2]> {
    let (mut enter, mut leave) = (0.0_f32, 1.0_f32);
    for axis in 0..3 {
        let (s, d) = (start[axis], displacement[axis]);
        let (low, high) = (bounds.min[axis], bounds.max[axis]);
        if d == 0.0 {
            if s < low || s > high {
                return None;
            }
            continue;
        }
        let (one, other) = ((low - s) / d, (high - s) / d);
        enter = enter.max(one.min(other));
        leave = leave.min(one.max(other));
    }
    (enter <= leave).then_some([enter, leave])
}
