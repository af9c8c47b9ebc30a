//! A body falls on the ground: one simulation.

use rapier3d::prelude::*;
use serde::Serialize;
use vps_compare::Prepared;
use vps_core::Quat;

use super::Settings;
use crate::experiments::shared::orientation::random_orientation;
use crate::experiments::shared::world::{StepSettings, World};
use crate::harness::context::Body;

/// One step of one simulation.
#[derive(Clone, Debug, Serialize)]
pub(super) struct StepRow {
    step: u32,
    time_s: f64,
    /// Number of collision queries of this step; 0 while the bounding boxes are apart.
    queries: u64,
    /// Total time of the queries.
    query_ns: u64,
    /// Number of contact points given to the engine.
    contacts: usize,
    /// Deepest penetration, negative if nothing touches yet.
    penetration_m: Option<f32>,
    /// Exact penetration of the mesh at the queried pose.
    true_penetration_m: f32,
    /// Velocity of the centre of mass after the step.
    linear_velocity_m_s: f32,
    angular_velocity_rad_s: f32,
    angular_velocity_x_rad_s: f32,
    angular_velocity_y_rad_s: f32,
    angular_velocity_z_rad_s: f32,
    /// Change of the angular velocity in the step.
    spin_change_rad_s: f32,
    kinetic_energy_j: f32,
    /// The queried pose.
    x_m: f32,
    y_m: f32,
    z_m: f32,
    qx: f32,
    qy: f32,
    qz: f32,
    qw: f32,
}

impl StepRow {
    /// The queried pose.
    pub(super) fn pose(&self) -> Pose {
        let rotation = Quat::from_xyzw(self.qx, self.qy, self.qz, self.qw);
        Pose::from_parts(Vector::new(self.x_m, self.y_m, self.z_m), rotation)
    }
}

impl Settings {
    /// Simulates one start orientation with one algorithm; a row for each step.
    ///
    /// # Errors
    /// When the algorithm does not support the pair of shapes.
    pub(super) fn simulate(
        &self,
        falling: &Body,
        prepared: &Prepared,
        frequency: u32,
        orientation: u32,
    ) -> Result<Vec<StepRow>, String> {
        let (mut world, body) = self.world(falling, prepared, frequency, orientation);
        let steps = self.steps(frequency);
        let mut rows = Vec::with_capacity(steps as usize);
        for step in 0..steps {
            let queried = *world.physics.bodies[body].position();
            let spin = world.physics.bodies[body].angvel();
            let queries = world.step()?;
            let (contacts, penetration_m) = world.contacts();
            let body = &world.physics.bodies[body];
            let new_spin = body.angvel();
            if !body.position().is_finite() {
                return Err(format!("the body left all bounds in step {step}"));
            }
            let (t, q) = (queried.translation, queried.rotation);
            rows.push(StepRow {
                step,
                time_s: f64::from(step) / f64::from(frequency),
                queries: queries.count,
                query_ns: queries.ns,
                contacts,
                penetration_m,
                true_penetration_m: falling.oracle.penetration(&queried, 0.0),
                linear_velocity_m_s: body.linvel().length(),
                angular_velocity_rad_s: new_spin.length(),
                angular_velocity_x_rad_s: new_spin.x,
                angular_velocity_y_rad_s: new_spin.y,
                angular_velocity_z_rad_s: new_spin.z,
                spin_change_rad_s: (new_spin - spin).length(),
                kinetic_energy_j: body.kinetic_energy(),
                x_m: t.x,
                y_m: t.y,
                z_m: t.z,
                qx: q.x,
                qy: q.y,
                qz: q.z,
                qw: q.w,
            });
        }
        Ok(rows)
    }

    /// The ground with its upper side at height 0, and the body above it.
    fn world(
        &self,
        falling: &Body,
        prepared: &Prepared,
        frequency: u32,
        orientation: u32,
    ) -> (World, RigidBodyHandle) {
        let step_settings = StepSettings {
            gravity_m_s2: self.gravity_m_s2.into(),
            frequency_hz: frequency,
            prediction_m: self.prediction_m.into(),
        };
        let mut world = step_settings.new_world(&prepared.dispatcher);
        let material = |shape: &SharedShape| {
            ColliderBuilder::new(shape.clone())
                .friction(self.friction)
                .restitution(self.restitution)
        };
        world.insert_ground(material(&prepared.ground), self.ground_extents_m);
        let rotation = random_orientation(self.seed, orientation);
        let center = falling.mass.center();
        let start = Vector::new(0.0, self.drop_height_m, 0.0) - rotation * center;
        let inertia = falling.mass.inertia_tensor(self.mass_kg);
        let mass = MassProperties::with_inertia_matrix(center, self.mass_kg, inertia);
        let pose = Pose::from_parts(start, rotation);
        let body = world.insert_body(material(&prepared.body), pose, mass);
        (world, body)
    }
}
