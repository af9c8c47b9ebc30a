//! Conversions between the numbers of a query, 32-bit, and those of rapier, 32-bit or 64-bit.
//!
//! A query takes the pose of one shape in the frame of the other, so that 32 bits suffice however far
//! both are from the origin of the world. The shapes themselves must lie near the origins of their own
//! frames: the corners of a triangle mesh become 32-bit numbers.

use rapier3d::math::{Pose, Real, Vector};
use vps_core::{Pose3, Vec3};

#[cfg(not(feature = "f64"))]
mod convert {
    use super::{Pose, Pose3, Real, Vec3, Vector};

    pub(crate) fn core_real(value: Real) -> f32 {
        value
    }

    pub(crate) fn core_vector(vector: Vector) -> Vec3 {
        vector
    }

    pub(crate) fn core_pose(pose: &Pose) -> Pose3 {
        *pose
    }

    pub(crate) fn real(value: f32) -> Real {
        value
    }

    pub(crate) fn vector(vector: Vec3) -> Vector {
        vector
    }
}

#[cfg(feature = "f64")]
mod convert {
    use super::{Pose, Pose3, Real, Vec3, Vector};

    pub(crate) fn core_real(value: Real) -> f32 {
        value as f32
    }

    pub(crate) fn core_vector(vector: Vector) -> Vec3 {
        vector.as_vec3()
    }

    pub(crate) fn core_pose(pose: &Pose) -> Pose3 {
        Pose3::from(*pose)
    }

    pub(crate) fn real(value: f32) -> Real {
        Real::from(value)
    }

    pub(crate) fn vector(vector: Vec3) -> Vector {
        vector.as_dvec3()
    }
}

pub(crate) use convert::{core_pose, core_real, core_vector, real, vector};
