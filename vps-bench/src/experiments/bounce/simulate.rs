//! A ball bounces: one simulation.

use rapier3d::prelude::*;
use serde::Serialize;
use vps_compare::Prepared;

use super::{Case, Settings};
use crate::experiments::shared::inertia::ball_inertia;
use crate::experiments::shared::orientation::random_orientation;
use crate::experiments::shared::world::StepSettings;

/// One step of one simulation.
#[derive(Clone, Debug, Serialize)]
pub(super) struct StepRow {
    step: u32,
    time_s: f64,
    /// Height of the centre at the queried pose.
    height_m: f32,
    /// Sideways distance of the centre from the exact one.
    aside_m: f32,
    /// Number of contact points given to the engine.
    contacts: usize,
    /// Deepest penetration, negative if nothing touches yet.
    penetration_m: Option<f32>,
    /// Exact penetration of a ball: its radius minus the height of the centre.
    true_penetration_m: f32,
    /// Upward velocity after the step.
    velocity_m_s: f32,
}

impl Settings {
    /// Simulates one start orientation; a row for each step, as long as the centre is above the
    /// upper side of the ground.
    ///
    /// # Errors
    /// When the algorithm does not support the pair of shapes, or the ball leaves the world.
    pub(super) fn simulate(
        &self,
        prepared: &Prepared,
        case: Case,
        orientation: u32,
    ) -> Result<Vec<StepRow>, String> {
        let step_settings = StepSettings {
            gravity_m_s2: self.gravity_m_s2,
            frequency_hz: self.frequency_hz,
            prediction_m: case.prediction_m,
        };
        let mut world = step_settings.new_world(&prepared.dispatcher);
        // Both have the same coefficients, and so has the pair, whose are the averages.
        let material = |shape: &SharedShape| {
            ColliderBuilder::new(shape.clone())
                .friction(self.friction as f32)
                .restitution(case.restitution as f32)
        };
        world.insert_ground(material(&prepared.ground), self.ground_extents_m);
        let start = Vector::new(0.0, self.drop_height_m as f32, 0.0);
        let rotation = random_orientation(self.seed, orientation);
        let mass = MassProperties::with_inertia_matrix(
            Vector::ZERO,
            self.mass_kg as f32,
            ball_inertia(self.mass_kg, self.radius_m),
        );
        let pose = Pose::from_parts(start, rotation);
        let ball = world.insert_body(material(&prepared.body), pose, mass);
        let mut rows = Vec::new();
        for step in 0..self.steps() {
            let center = world.physics.bodies[ball].translation();
            let [x, _, z] = self.ground_extents_m.map(|e| 0.5 * e as f32);
            if center.x.abs() > x || center.z.abs() > z {
                break;
            }
            world.step()?;
            let (contacts, penetration_m) = world.contacts();
            let body = &world.physics.bodies[ball];
            if !body.position().is_finite() {
                return Err(format!("the ball left all bounds in step {step}"));
            }
            rows.push(StepRow {
                step,
                time_s: f64::from(step) / f64::from(self.frequency_hz),
                height_m: center.y,
                aside_m: center.with_y(0.0).length(),
                contacts,
                penetration_m,
                true_penetration_m: self.radius_m as f32 - center.y,
                velocity_m_s: body.linvel().y,
            });
        }
        Ok(rows)
    }
}
