//! Times of the steps of a world with many bodies at rest.

use std::time::Instant;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rapier3d::prelude::*;
use vps_compare::Prepared;

use super::{Settings, TimeRow};
use crate::experiments::shared::orientation::orientation_of;
use crate::experiments::shared::world::{StepSettings, World};
use crate::harness::context::{Body, Context};

impl Settings {
    pub(super) fn steps(&self, algorithm: &str, context: &Context) -> Result<Vec<TimeRow>, String> {
        let body = context.body(&self.model, self.scale)?;
        let ready = context.prepare_on_box(algorithm, &body, self.ground_extents_m)?;
        let prepared = ready.prepared()?;
        let mut rows = Vec::new();
        for &count in &self.bodies.counts {
            let mut world = self.world(&body, prepared, count);
            for _ in 0..self.bodies.settling_steps {
                world.step()?;
            }
            for sample in 0..self.bodies.timed_steps {
                let start = Instant::now();
                world.step()?;
                let time_us = start.elapsed().as_secs_f64() * 1e6;
                let bodies = f64::from(count);
                rows.push(TimeRow {
                    size: bodies,
                    sample,
                    time_us: time_us / bodies,
                    contacts: world.contacts().0 as f64 / bodies,
                });
            }
            let lowest = world
                .physics
                .bodies
                .iter()
                .map(|(_, body)| body.translation().y);
            if lowest.fold(0.0, f32::min) < -self.bodies.spacing_m {
                return Err(format!("of {count} bodies one fell through the ground"));
            }
        }
        Ok(rows)
    }

    /// Bodies in random orientations on a square grid, a little above an exact box: a voxelmap of
    /// the ground would differ for each number of bodies.
    fn world(&self, body: &Body, prepared: &Prepared, count: u32) -> World {
        let settings = &self.bodies;
        let step_settings = StepSettings {
            gravity_m_s2: settings.gravity_m_s2.into(),
            frequency_hz: settings.frequency_hz,
            prediction_m: self.prediction_m.into(),
        };
        let mut world = step_settings.new_world(&prepared.dispatcher);
        let side = f64::from(count).sqrt().ceil() as u32;
        let width = settings.spacing_m * side as f32;
        let half = width + 1.0;
        let extents_m = [half, 0.1, half].map(|half| 2.0 * f64::from(half));
        world.insert_ground(ColliderBuilder::cuboid(half, 0.1, half), extents_m);

        let mut rng = ChaCha8Rng::seed_from_u64(self.seed);
        let center = body.mass.center();
        let inertia = body.mass.inertia_tensor(settings.mass_kg);
        let mass = MassProperties::with_inertia_matrix(center, settings.mass_kg, inertia);
        for i in 0..count {
            let turned = Pose::from_parts(Vector::ZERO, orientation_of(rng.random()));
            let height = body.oracle.penetration(&turned, 0.0) + self.fixed_depth_m;
            let place = |i: u32| (i as f32 + 0.5) * settings.spacing_m - 0.5 * width;
            let start = Vector::new(place(i % side), height, place(i / side));
            let shape = ColliderBuilder::new(prepared.body.clone());
            world.insert_body(shape, Pose::from_parts(start, turned.rotation), mass);
        }
        world
    }
}
