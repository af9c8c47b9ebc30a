//! The errors of a coupling and of its steps.

/// Why a coupling was refused.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum CouplingError {
    /// A mass, a stiffness or a limit is not positive and finite.
    #[error("{name} must be positive and finite, not {value}")]
    NotPositive {
        /// Name of the parameter.
        name: &'static str,
        /// Given value.
        value: f32,
    },
    /// A damping is negative or not finite.
    #[error("{name} must be finite and not negative, not {value}")]
    Negative {
        /// Name of the parameter.
        name: &'static str,
        /// Given value.
        value: f32,
    },
    /// The inertia is not symmetric and positive definite.
    #[error("the inertia must be symmetric and positive definite")]
    Inertia,
    /// The initial pose or the centre of the tool is not finite.
    #[error("pose and centre of the tool must be finite")]
    Pose,
}

/// Why a step was refused.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum StepError {
    /// The device's pose is not finite, or out of the range of 32-bit numbers.
    #[error("the pose of the device is not finite")]
    Device,
    /// The contacts' force, torque or stiffness is not finite.
    #[error("the contact wrench is not finite")]
    Contact,
    /// The time step is not positive and finite, or so long that the tool would leave the range of
    /// 32-bit numbers.
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
