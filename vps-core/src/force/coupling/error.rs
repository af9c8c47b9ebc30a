//! The errors of a coupling and of its steps.

/// Why a coupling was refused.
///
/// ```
/// use vps_core::{CouplingError, CouplingOptions, Mat3, Pose3, Tool, Vec3, VirtualCoupling};
///
/// let tool = Tool {
///     mass: 0.1,
///     inertia: Mat3::from_diagonal(Vec3::splat(1e-5)),
///     center: Vec3::ZERO,
/// };
/// let options = CouplingOptions::critically_damped(&tool, 1000.0, 2.0);
/// let weightless = Tool { mass: 0.0, ..tool };
/// let refused = VirtualCoupling::new(weightless, options, Pose3::IDENTITY);
/// assert_eq!(
///     refused.unwrap_err(),
///     CouplingError::NotPositive { name: "mass", value: 0.0 }
/// );
/// ```
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
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
///
/// ```
/// use vps_core::{CouplingError, CouplingOptions, LinearWrench, Mat3, Pose3, StepError, Tool, Vec3,
///     VirtualCoupling,};
///
/// let tool = Tool {
///     mass: 0.1,
///     inertia: Mat3::from_diagonal(Vec3::splat(1e-5)),
///     center: Vec3::ZERO,
/// };
/// let options = CouplingOptions::critically_damped(&tool, 1000.0, 2.0);
/// let mut coupling = VirtualCoupling::new(tool, options, Pose3::IDENTITY)?;
/// let step = coupling.step(Pose3::IDENTITY, LinearWrench::ZERO, 0.0);
/// assert_eq!(step, Err(StepError::TimeStep(0.0)));
/// # Ok::<(), CouplingError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
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
