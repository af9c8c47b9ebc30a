//! Why a coupling is refused, and why a step is.

/// Why there cannot be such a coupling.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum CouplingError {
    /// A mass, a stiffness or a limit.
    #[error("{name} must be positive and finite, not {value}")]
    NotPositive {
        /// Which.
        name: &'static str,
        /// What was given.
        value: f32,
    },
    /// A damping.
    #[error("{name} must be finite and not negative, not {value}")]
    Negative {
        /// Which.
        name: &'static str,
        /// What was given.
        value: f32,
    },
    /// The inertia of a body.
    #[error("the inertia must be symmetric and positive definite")]
    Inertia,
    /// A place to start from.
    #[error("pose and centre of the tool must be finite")]
    Pose,
}

/// Why a step was not made.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum StepError {
    /// The device's pose is not finite, or further away than 32 bits can tell.
    #[error("the pose of the device is not finite")]
    Device,
    /// The contacts' force, torque or stiffness is not finite.
    #[error("the contact wrench is not finite")]
    Contact,
    /// Not positive and finite, or so long that the tool would leave what 32 bits can tell.
    #[error("a step must take a positive and finite time, not {0} s")]
    TimeStep(f32),
}

pub(super) fn check_positive(name: &'static str, value: f32) -> Result<(), CouplingError> {
    if value > 0.0 && value.is_finite() {
        Ok(())
    } else {
        Err(CouplingError::NotPositive { name, value })
    }
}
