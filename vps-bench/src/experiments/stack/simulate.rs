//! A stack of balls: one simulation.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rapier3d::prelude::*;
use serde::Serialize;
use vps_compare::Prepared;

use super::Settings;
use crate::experiments::shared::inertia::ball_inertia;
use crate::experiments::shared::orientation::orientation_of;
use crate::experiments::shared::world::{StepSettings, World};

/// The result of one stack.
#[derive(Clone, Debug, Serialize)]
pub(super) struct StackRow {
    /// Time until the stack fell; the duration of the simulation if it never did.
    stood_s: f64,
    /// 1 if it fell, otherwise 0.
    fell: u32,
    /// While it stood, between neighbouring balls, or the lowest ball and the ground.
    true_penetration_m_max: f64,
    /// While it stood, the distance of the topmost centre from the vertical through its start.
    sway_m_max: f64,
}

/// Detects when a stack falls: its topmost centre is below half of its height at the start.
///
/// For two balls that is halfway to the ground the upper one rolls down to; a higher stack has lost
/// at least half of its height.
struct FallDetector {
    fallen_below_m: f64,
    fell_at_s: Option<f64>,
}

impl FallDetector {
    fn new(start_height_m: f64) -> Self {
        Self {
            fallen_below_m: 0.5 * start_height_m,
            fell_at_s: None,
        }
    }

    /// Updates with the height of the topmost centre at a time and returns whether the stack
    /// stands.
    fn stands(&mut self, time_s: f64, height_m: f64) -> bool {
        if height_m < self.fallen_below_m && self.fell_at_s.is_none() {
            self.fell_at_s = Some(time_s);
        }
        self.fell_at_s.is_none()
    }
}

impl Settings {
    /// Simulates one stack until it falls.
    ///
    /// # Errors
    /// When the algorithm does not support the pair of shapes, or a ball leaves the world.
    pub(super) fn simulate(
        &self,
        prepared: &Prepared,
        balls: u32,
        stack: u32,
    ) -> Result<StackRow, String> {
        let (mut world, handles) = self.world(prepared, balls, stack);
        let centers = |world: &World| -> Vec<Vector> {
            handles
                .iter()
                .map(|&ball| world.physics.bodies[ball].translation())
                .collect()
        };
        let start = centers(&world)[handles.len() - 1];
        let mut detector = FallDetector::new(start.y.into());
        let mut row = StackRow {
            stood_s: self.duration_s,
            fell: 0,
            true_penetration_m_max: 0.0,
            sway_m_max: 0.0,
        };
        for step in 0..=self.steps() {
            let time = f64::from(step) / f64::from(self.frequency_hz);
            let centers = centers(&world);
            let top = centers[centers.len() - 1];
            if !top.is_finite() {
                return Err(format!("a ball left all bounds in step {step}"));
            }
            if !detector.stands(time, top.y.into()) {
                break;
            }
            let deepest = self.penetration(&centers);
            row.true_penetration_m_max = row.true_penetration_m_max.max(deepest);
            let sway = f64::from((top - start).with_y(0.0).length());
            row.sway_m_max = row.sway_m_max.max(sway);
            world.step()?;
        }
        if let Some(time) = detector.fell_at_s {
            row.stood_s = time;
            row.fell = 1;
        }
        Ok(row)
    }

    /// The deepest penetration of neighbours, exact for balls.
    fn penetration(&self, centers: &[Vector]) -> f64 {
        let between = centers.windows(2).map(|pair| {
            let distance = f64::from(pair[0].distance(pair[1]));
            2.0 * self.radius_m - distance
        });
        let below = self.radius_m - f64::from(centers[0].y);
        between.fold(below, f64::max)
    }

    /// The ground with its upper side at height 0, and the balls, each touching the next, from the
    /// lowest to the topmost.
    fn world(&self, prepared: &Prepared, balls: u32, stack: u32) -> (World, Vec<RigidBodyHandle>) {
        let step_settings = StepSettings {
            gravity_m_s2: self.gravity_m_s2,
            frequency_hz: self.frequency_hz,
            prediction_m: self.prediction_m,
        };
        let mut world = step_settings.new_world(&prepared.dispatcher);
        let material = |shape: &SharedShape| {
            ColliderBuilder::new(shape.clone())
                .friction(self.friction as f32)
                .restitution(0.0)
        };
        world.insert_ground(material(&prepared.ground), self.ground_extents_m);
        let inertia = ball_inertia(self.mass_kg, self.radius_m);
        let mass = MassProperties::with_inertia_matrix(Vector::ZERO, self.mass_kg as f32, inertia);
        let mut rng = ChaCha8Rng::seed_from_u64(self.seed.wrapping_add(u64::from(stack)));
        let handles = (0..balls).map(|number| {
            // Uniform in a disc.
            let [area, turn]: [f64; 2] = rng.random();
            let (sin, cos) = (turn * std::f64::consts::TAU).sin_cos();
            let aside = self.offset_m * area.sqrt();
            let height = self.radius_m * f64::from(2 * number + 1);
            let center = Vector::new((aside * cos) as f32, height as f32, (aside * sin) as f32);
            let pose = Pose::from_parts(center, orientation_of(rng.random()));
            world.insert_body(material(&prepared.body), pose, mass)
        });
        let handles = handles.collect();
        (world, handles)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stack_falls_when_its_top_is_below_half_its_height() {
        let mut detector = FallDetector::new(1.5);
        assert!(detector.stands(0.0, 1.5));
        assert!(detector.stands(1.0, 0.75));
        assert!(!detector.stands(2.0, 0.74));
        assert_eq!(detector.fell_at_s, Some(2.0));
        // It does not stand up again.
        assert!(!detector.stands(3.0, 1.5));
        assert_eq!(detector.fell_at_s, Some(2.0));
    }
}
