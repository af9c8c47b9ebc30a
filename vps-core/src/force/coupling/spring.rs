//! A spring and a damper, implicitly integrated.

use glamx::{DVec3, Vec3};

/// A spring and a damper from the tool to the device, linear or angular.
pub(super) struct Spring {
    stiffness: f64,
    damping: f64,
    /// Limit of the sum of both that the device renders.
    limit: f64,
    /// From the tool to the device, before the step.
    offset: DVec3,
    device_velocity: DVec3,
}

impl Spring {
    /// From stiffness, damping and limit. A spring beyond its limit is replaced by the softer one
    /// that exerts the limit: its quadratic potential touches the true one at the tool and is
    /// nowhere below it, so that an implicit step cannot add energy.
    pub(super) fn new(
        (stiffness, damping, limit): (f32, f32, f32),
        offset: Vec3,
        device_velocity: DVec3,
    ) -> Self {
        let (limit, offset) = (f64::from(limit), offset.as_dvec3());
        let limiting_stiffness = limit / offset.length();
        Self {
            stiffness: limiting_stiffness.min(stiffness.into()),
            damping: damping.into(),
            limit,
            offset,
            device_velocity,
        }
    }

    /// The implicit drag coefficient of a step of `h` seconds in kg or kg m², and the impulse that
    /// does not depend on the velocity at its end.
    pub(super) fn implicit(&self, h: f64) -> (f64, DVec3) {
        let (stiffness, damping) = (h * self.stiffness, h * self.damping);
        let impulse = damping * self.device_velocity + stiffness * self.offset;
        (damping + h * stiffness, impulse)
    }

    /// The force or torque that the device exerts on the user at the end of the step.
    pub(super) fn on_device(&self, velocity: DVec3, h: f64) -> Vec3 {
        let spring = self.stiffness * (self.offset - h * velocity);
        let damper = self.damping * (self.device_velocity - velocity);
        (-spring - damper).clamp_length_max(self.limit).as_vec3()
    }
}
