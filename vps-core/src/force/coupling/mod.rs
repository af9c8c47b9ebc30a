//! Virtual coupling: a tool on a spring and a damper that a haptic device moves.

mod error;
mod options;
mod spring;
mod system;

use glamx::{DMat3, DVec3, Mat3, Pose3, Quat, Vec3};

use self::error::check_positive;
pub use self::error::{CouplingError, StepError};
pub use self::options::{CouplingOptions, Tool};
use self::spring::Spring;
use self::system::System;
use crate::force::linear_wrench::LinearWrench;
use crate::force::wrench::Wrench;

/// A spring and a damper between the pose of a haptic device and a simulated tool: the device feels
/// what the tool touches, and the tool cannot be pushed through it (Colgate, Stanley and Brown 1995;
/// for six degrees of freedom McNeely, Puterbaugh and Troy 1999).
///
/// All poses are those of the tool's frame in the world; the device's pose is the one the user
/// wants the tool to have. In each cycle, query the contacts at [`pose`](Self::pose) and call
/// [`step`](Self::step):
///
/// ```
/// use vps_core::{
///     CouplingOptions, DistanceField, PointSphereTree, Pose3, Query, StepError, Tool,
///     VirtualCoupling, Weight, Wrench,
/// };
///
/// /// One cycle of 1 ms with a solid of 2·10⁹ N/m³ that rests in the world.
/// fn cycle(
///     coupling: &mut VirtualCoupling, tree: &PointSphereTree<'_>, solid: &impl DistanceField,
///     solid_pose: Pose3, device: Pose3,
/// ) -> Result<Wrench, StepError> {
///     let pose = coupling.pose();
///     let contact = Query::new(tree, solid, solid_pose.inv_mul(&pose))
///         .linear_wrench(coupling.tool().center, Weight::Area);
///     let contact = (contact * 2e9).rotated(pose.rotation); // from the shell frame to the world
///     coupling.step(device, contact, 1e-3) // on an error, coupling.rendered() is the last wrench
/// }
/// ```
///
/// # Stability
/// Springs, dampers and contacts are integrated implicitly, contacts by their [`LinearWrench`]
/// (Otaduy and Lin 2006). The quadratic potential of the points in contact with a convex solid
/// touches the true one at the tool, and is nowhere below it. While the device rests, contacts
/// match their wrench and rotations within a step are small, a step adds no energy, for any mass,
/// stiffness and time step. Contacts that are stiffer than stated along some axis are stable up to
/// the sum of 4 m / dt² and twice the stated stiffness; so a bare [`Wrench`], which states none, is
/// stable up to 4 m / dt² (a tool of 0.1 kg at 1 kHz: 400 kN/m). Beyond that, and with any wrench,
/// speeds stay below `max_speed` and `max_angular_speed`, force and torque below `max_force` and
/// `max_torque`. The gyroscopic torque, which does no work and is small at the speed of hands, is
/// neglected.
///
/// A contact is detected once the tool has entered it, by up to the motion of a step. A single
/// contact returns less energy than it took. Several that begin in different steps may together
/// return slightly more (4 % in a random case of two), which the dampers dissipate.
///
/// Coordinates have 32 bits: at 0.1 m from the origin of the world their resolution is 7 nm, which a
/// contact of 10⁷ N/m turns into 0.07 N.
///
/// The device closes a loop of its own. While the tool is held it feels a spring and a damper
/// sampled every dt, and to stay passive must itself damp more than `stiffness` · dt / 2 + `damping`
/// (Colgate and Schenkel 1997): a light tool needs little of the latter.
///
/// # Steady state
/// A device that is d metres deep in a solid of k N/m feels d / (1/`stiffness` + 1/k): the tool
/// stays at the surface, apart from the force divided by k. The spring force is limited to
/// `max_force`, and with it the force of the tool on the solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VirtualCoupling {
    tool: Tool,
    options: CouplingOptions,
    /// Lower bound on the principal moments of inertia, in kg m².
    min_moment: f64,
    pose: Pose3,
    velocity: Vec3,
    angular_velocity: Vec3,
    device: Pose3,
    rendered: Wrench,
}

impl VirtualCoupling {
    /// A tool at rest at the pose of the device.
    ///
    /// # Errors
    /// If a parameter is invalid: see [`CouplingError`].
    pub fn new(tool: Tool, options: CouplingOptions, pose: Pose3) -> Result<Self, CouplingError> {
        check_positive("mass", tool.mass)?;
        options.check()?;
        let pose = normalized(pose).ok_or(CouplingError::Pose)?;
        if !pose.transform_point(tool.center).is_finite() {
            return Err(CouplingError::Pose);
        }
        Ok(Self {
            tool,
            options,
            min_moment: min_moment(&tool.inertia).ok_or(CouplingError::Inertia)?,
            pose,
            velocity: Vec3::ZERO,
            angular_velocity: Vec3::ZERO,
            device: pose,
            rendered: Wrench::default(),
        })
    }

    /// The tool.
    pub fn tool(&self) -> &Tool {
        &self.tool
    }

    /// Spring, damper and limits.
    pub fn options(&self) -> &CouplingOptions {
        &self.options
    }

    /// Pose of the tool in the world.
    pub fn pose(&self) -> Pose3 {
        self.pose
    }

    /// Velocity of the tool's centre, in m/s in the world.
    pub fn velocity(&self) -> Vec3 {
        self.velocity
    }

    /// Angular velocity of the tool, in rad/s in the world.
    pub fn angular_velocity(&self) -> Vec3 {
        self.angular_velocity
    }

    /// Pose of the device in the last step.
    pub fn device(&self) -> Pose3 {
        self.device
    }

    /// The wrench of the last step.
    pub fn rendered(&self) -> Wrench {
        self.rendered
    }

    /// Advances the tool by `dt` seconds. Returns the force in N and the torque in N m that the
    /// device should exert on the user, in the world, the torque about the tool's centre. `contact`
    /// is the wrench of the contacts on the tool at [`pose`](Self::pose), in the world and about
    /// its centre: a [`LinearWrench`], or a [`Wrench`] if its derivative is unknown.
    ///
    /// Solves six equations; allocates nothing.
    ///
    /// # Errors
    /// If an argument is not finite. The state is unchanged then, and [`rendered`](Self::rendered)
    /// is still the wrench of the last successful step. The motion of the device since then counts
    /// as that of the next successful step.
    pub fn step(
        &mut self,
        device: Pose3,
        contact: impl Into<LinearWrench>,
        dt: f32,
    ) -> Result<Wrench, StepError> {
        let contact = contact.into();
        if !(dt > 0.0 && dt.is_finite()) {
            return Err(StepError::TimeStep(dt));
        }
        if !contact.is_finite() {
            return Err(StepError::Contact);
        }
        let device = normalized(device).ok_or(StepError::Device)?;
        let center = |pose: &Pose3| pose.transform_point(self.tool.center);
        let displacement = center(&device) - center(&self.device);
        let rotation = rotation_vector(self.device.rotation, device.rotation);
        let offset = center(&device) - center(&self.pose);
        if !(displacement / dt).is_finite() || !(rotation / dt).is_finite() || !offset.is_finite() {
            return Err(StepError::Device);
        }

        let options = &self.options;
        let linear = Spring::new(
            (options.stiffness, options.damping, options.max_force),
            offset,
            clamp_length((displacement / dt).as_dvec3(), options.max_speed),
        );
        let angular = Spring::new(
            (
                options.angular_stiffness,
                options.angular_damping,
                options.max_torque,
            ),
            rotation_vector(self.pose.rotation, device.rotation),
            clamp_length((rotation / dt).as_dvec3(), options.max_angular_speed),
        );
        let (velocity, angular_velocity) = self.solve(&linear, &angular, &contact, dt.into());
        let center = center(&self.pose) + velocity.as_vec3() * dt;
        let rotated = Quat::from_scaled_axis(angular_velocity.as_vec3() * dt) * self.pose.rotation;
        let rotation = rotated.normalize();
        let pose = Pose3::from_parts(center - rotation * self.tool.center, rotation);
        if !pose.is_finite() {
            return Err(StepError::TimeStep(dt));
        }
        self.pose = pose;
        self.velocity = velocity.as_vec3();
        self.angular_velocity = angular_velocity.as_vec3();
        self.device = device;
        self.rendered = Wrench {
            force: linear.on_device(velocity, dt.into()),
            torque: angular.on_device(angular_velocity, dt.into()),
        };
        Ok(self.rendered)
    }

    /// The velocities at the end of a step of `h` seconds.
    fn solve(
        &self,
        linear: &Spring,
        angular: &Spring,
        contact: &LinearWrench,
        h: f64,
    ) -> (DVec3, DVec3) {
        let options = &self.options;
        let rotation = Mat3::from_quat(self.pose.rotation);
        let inertia = (rotation * self.tool.inertia * rotation.transpose()).as_dmat3();
        let mass = f64::from(self.tool.mass);
        // The forces of contacts are those at the end of the step.
        let implicit_factor = h * (h + f64::from(options.contact_damping));
        let matrix = |stiffness: Mat3| implicit_factor * stiffness.as_dmat3();
        let (drag, impulse) = linear.implicit(h);
        let (angular_drag, angular_impulse) = angular.implicit(h);
        let diagonal = |value: f64| DMat3::from_diagonal(DVec3::splat(value));
        let system = System {
            linear: diagonal(mass + drag) + matrix(contact.translational),
            mixed: matrix(contact.mixed),
            angular: inertia + diagonal(angular_drag) + matrix(contact.rotational),
            momentum: mass * self.velocity.as_dvec3()
                + h * contact.wrench.force.as_dvec3()
                + impulse,
            angular_momentum: inertia * self.angular_velocity.as_dvec3()
                + h * contact.wrench.torque.as_dvec3()
                + angular_impulse,
        };
        let (velocity, angular_velocity) = system.solved(mass, self.min_moment);
        (
            clamp_length(velocity, options.max_speed),
            clamp_length(angular_velocity, options.max_angular_speed),
        )
    }
}

/// A vector clamped to a length; zero if its length exceeds 64-bit numbers.
fn clamp_length(vector: DVec3, length: f32) -> DVec3 {
    let clamped = vector.clamp_length_max(length.into());
    if clamped.is_finite() {
        clamped
    } else {
        DVec3::ZERO
    }
}

/// The pose with its rotation normalised; `None` if that is impossible.
fn normalized(pose: Pose3) -> Option<Pose3> {
    let length = pose.rotation.length();
    let is_valid = pose.is_finite() && length.is_finite() && length > 0.0;
    is_valid.then(|| Pose3::from_parts(pose.translation, pose.rotation.normalize()))
}

/// The rotation by the smaller angle, as axis times angle.
fn rotation_vector(from: Quat, to: Quat) -> Vec3 {
    let rotation = to * from.conjugate();
    let rotation = if rotation.w < 0.0 {
        -rotation
    } else {
        rotation
    };
    rotation.to_scaled_axis()
}

/// A positive lower bound on the principal moments of inertia, in kg m².
fn min_moment(inertia: &Mat3) -> Option<f64> {
    let inertia = inertia.as_dmat3();
    let largest = inertia.to_cols_array().into_iter().fold(0.0, f64::max);
    let symmetric = (inertia - inertia.transpose()).to_cols_array();
    let is_symmetric = symmetric.iter().all(|d| d.abs() <= 1e-4 * largest);
    let [x, y] = [inertia.x_axis, inertia.y_axis];
    let minor = x.x * y.y - x.y * y.x;
    let is_definite = x.x > 0.0 && minor > 0.0 && inertia.determinant() > 0.0;
    if !(inertia.is_finite() && is_symmetric && is_definite) {
        return None;
    }
    // The sum of the reciprocals of all three exceeds that of the smallest.
    let inverse = inertia.inverse();
    let min_moment = 1.0 / (inverse.x_axis.x + inverse.y_axis.y + inverse.z_axis.z);
    (min_moment > 0.0 && min_moment.is_finite()).then_some(min_moment)
}
