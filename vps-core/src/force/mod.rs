//! Penalty forces, their derivative by the pose, and the virtual coupling to a haptic device.

mod coupling;
mod linear_wrench;
pub(crate) mod wrench;

pub use self::coupling::{CouplingError, CouplingOptions, StepError, Tool, VirtualCoupling};
pub use self::linear_wrench::LinearWrench;
pub use self::wrench::{Weight, Wrench};
