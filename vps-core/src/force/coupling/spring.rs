//! A spring and a damper, implicitly integrated.

use glamx::{DVec3, Vec3};

/// A spring and a damper from the tool to the device, linear or angular.
pub(super) struct Spring {
    stiffness: f64,
    damping: f64,
    /// The most that both together do to the device.
    limit: f64,
    /// From the tool to the device, before the step.
    offset: DVec3,
    device_velocity: DVec3,
}

impl Spring {
    /// Of stiffness, damping and limit. One that would be beyond its limit is as much softer as it
    /// takes: the quadratic potential of that one touches the true one where the tool is and is
    /// nowhere below it, so that an implicit step cannot add energy.
    pub(super) fn new(
        (stiffness, damping, limit): (f32, f32, f32),
        offset: Vec3,
        device_velocity: DVec3,
    ) -> Self {
        let (limit, offset) = (f64::from(limit), offset.as_dvec3());
        let softer = limit / offset.length();
        Self {
            stiffness: softer.min(stiffness.into()),
            damping: damping.into(),
            limit,
            offset,
            device_velocity,
        }
    }

    /// The momentum a velocity at the end of a step of `h` seconds costs, per velocity, and what is
    /// gained whatever it is.
    pub(super) fn implicit(&self, h: f64) -> (f64, DVec3) {
        let (stiffness, damping) = (h * self.stiffness, h * self.damping);
        let push = damping * self.device_velocity + stiffness * self.offset;
        (damping + h * stiffness, push)
    }

    /// What the device exerts on the user at the end of the step.
    pub(super) fn on_device(&self, velocity: DVec3, h: f64) -> Vec3 {
        let spring = self.stiffness * (self.offset - h * velocity);
        let damper = self.damping * (self.device_velocity - velocity);
        (-spring - damper).clamp_length_max(self.limit).as_vec3()
    }
}
