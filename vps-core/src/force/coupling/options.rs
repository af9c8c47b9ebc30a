//! The tool, and the parameters of spring, damper and limits.

use glamx::{Mat3, Vec3};
use wide::f32x4;

use super::error::{CouplingError, check_positive};
use crate::asset::MassProperties;

/// The simulated body that a haptic device moves.
///
/// Mass and inertia need not be those of a real tool: the lighter it is, the less its inertia is
/// felt and the less damping it needs. A light tool is stable with contacts of any stiffness whose
/// [`LinearWrench`](crate::LinearWrench) is known.
///
/// ```
/// use vps_core::{MassProperties, Tool};
///
/// // A cube of a decimetre.
/// let cube = MassProperties {
///     volume: 1e-3,
///     center_of_mass: [0.0; 3],
///     inertia: [1e-5 / 6.0, 1e-5 / 6.0, 1e-5 / 6.0, 0.0, 0.0, 0.0],
/// };
/// let tool = Tool::of(&cube, 0.6);
/// assert!((tool.inertia.x_axis.x - 1e-3).abs() < 1e-7);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tool {
    /// In kg.
    pub mass: f32,
    /// Inertia tensor about the centre in kg m², along the axes of the tool's frame.
    pub inertia: Mat3,
    /// The centre of mass in metres, in the tool's frame. Spring and damper act there, and all
    /// torques are about it.
    pub center: Vec3,
}

impl Tool {
    /// A homogeneous tool of `mass` kg.
    pub fn of(properties: &MassProperties, mass: f32) -> Self {
        Self {
            mass,
            inertia: properties.inertia_tensor(mass),
            center: properties.center(),
        }
    }
}

/// Spring, damper and limits of a [`VirtualCoupling`](crate::VirtualCoupling).
///
/// ```
/// use vps_core::{CouplingOptions, Mat3, Tool, Vec3};
///
/// let tool = Tool {
///     mass: 0.1,
///     inertia: Mat3::from_diagonal(Vec3::splat(1e-5)),
///     center: Vec3::ZERO,
/// };
/// let options = CouplingOptions {
///     max_force: 3.0,
///     ..CouplingOptions::critically_damped(&tool, 1000.0, 2.0)
/// };
/// assert!((options.damping - 20.0).abs() < 1e-4);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CouplingOptions {
    /// Of the spring between the centres, in N/m.
    pub stiffness: f32,
    /// Of the damper between the centres, in N s/m.
    pub damping: f32,
    /// Of the spring between the orientations, in N m/rad.
    pub angular_stiffness: f32,
    /// Of the damper between the orientations, in N m s/rad.
    pub angular_damping: f32,
    /// Damping of contacts in seconds, relative to their stiffness: a contact of k N/m has this
    /// times k N s/m.
    pub contact_damping: f32,
    /// The largest force in N that the device renders and the spring exerts.
    pub max_force: f32,
    /// The same for torques, in N m.
    pub max_torque: f32,
    /// Limit in m/s of the speeds of device and tool.
    pub max_speed: f32,
    /// The same in rad/s.
    pub max_angular_speed: f32,
}

impl CouplingOptions {
    /// Springs of N/m and N m/rad that are critically damped with that tool, about the axis of
    /// largest inertia; contacts damp 1 ms of their stiffness. At most 10 N, 0.5 N m, 5 m/s and
    /// 50 rad/s.
    pub fn critically_damped(tool: &Tool, stiffness: f32, angular_stiffness: f32) -> Self {
        // The moment of inertia about any axis is at most half of the trace.
        let Mat3 {
            x_axis: x,
            y_axis: y,
            z_axis: z,
        } = tool.inertia;
        let inertia = 0.5 * (x.x + y.y + z.z);
        let products = f32x4::new([stiffness * tool.mass, angular_stiffness * inertia, 0.0, 0.0]);
        let [linear, angular, ..] = products.sqrt().to_array();
        Self {
            stiffness,
            damping: 2.0 * linear,
            angular_stiffness,
            angular_damping: 2.0 * angular,
            contact_damping: 1e-3,
            max_force: 10.0,
            max_torque: 0.5,
            max_speed: 5.0,
            max_angular_speed: 50.0,
        }
    }

    pub(super) fn check(&self) -> Result<(), CouplingError> {
        let positive = [
            ("stiffness", self.stiffness),
            ("angular_stiffness", self.angular_stiffness),
            ("max_force", self.max_force),
            ("max_torque", self.max_torque),
            ("max_speed", self.max_speed),
            ("max_angular_speed", self.max_angular_speed),
        ];
        for (name, value) in positive {
            check_positive(name, value)?;
        }
        let not_negative = [
            ("damping", self.damping),
            ("angular_damping", self.angular_damping),
            ("contact_damping", self.contact_damping),
        ];
        for (name, value) in not_negative {
            if !(value >= 0.0 && value.is_finite()) {
                return Err(CouplingError::Negative { name, value });
            }
        }
        Ok(())
    }
}
