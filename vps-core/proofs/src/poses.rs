//! Random poses.

use proptest::prelude::*;
use vps_core::{Pose3, Quat};

use crate::support::{direction, vector};

/// Any rotation, and a translation of up to `size` metres along each axis.
pub(crate) fn pose(size: f32) -> impl Strategy<Value = Pose3> {
    (direction(), 0.0..6.3_f32, vector(size)).prop_map(|(axis, angle, translation)| {
        Pose3::from_parts(translation, Quat::from_axis_angle(axis, angle))
    })
}
