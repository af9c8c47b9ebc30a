//! A ball bounces: one simulation.

use rapier3d::prelude::*;
use serde::Serialize;
use vps_compare::Prepared;

use super::{Case, Settings};
use crate::experiments::orientation::random_orientation;
use crate::experiments::world::Stepping;

/// One step of one simulation.
#[derive(Clone, Debug, Serialize)]
pub(super) struct StepRow {
    step: u32,
    time_s: f64,
    /// Of the centre, at the pose that was asked about.
    height_m: f32,
    /// How far the centre is from where it would be, sideways.
    aside_m: f32,
    /// Contact points given to the engine.
    contacts: usize,
    /// The deepest of them, negative if none touches yet.
    penetration_m: Option<f32>,
    /// Exact for a ball: the radius without the height of the centre.
    true_penetration_m: f32,
    /// After the step, upwards.
    velocity_m_s: f32,
}

impl Settings {
    /// Simulates one start orientation; a row a step, as long as the centre is above the ground's
    /// upper side.
    ///
    /// # Errors
    /// When the engine could not ask the algorithm, or the ball leaves all bounds.
    pub(super) fn simulate(
        &self,
        prepared: &Prepared,
        case: Case,
        orientation: u32,
    ) -> Result<Vec<StepRow>, String> {
        let stepping = Stepping {
            gravity_m_s2: self.gravity_m_s2,
            frequency_hz: self.frequency_hz,
            prediction_m: case.prediction_m,
        };
        let mut world = stepping.world(&prepared.dispatcher);
        // Both have the same coefficients: the pair's, the average of the two, is that as well.
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

/// Of a solid ball about its centre.
pub(in crate::experiments) fn ball_inertia(mass_kg: f64, radius_m: f64) -> Matrix {
    Matrix::from_diagonal(Vector::splat((0.4 * mass_kg * radius_m * radius_m) as f32))
}
