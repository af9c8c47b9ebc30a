//! A body falls on the ground: one simulation.

use std::sync::Arc;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rapier3d::prelude::*;
use vps_compare::oracle::PlaneOracle;
use vps_compare::{Prepared, summary};
use vps_core::Quat;

use crate::config::Experiment;
use crate::records::StepRow;
use crate::timed::{Stopwatch, Timed};

/// What all algorithms of an experiment share.
pub(crate) struct Drop<'e> {
    pub(crate) experiment: &'e Experiment,
    /// Of the body's mesh, at density one.
    pub(crate) mass: vps_core::MassProperties,
    pub(crate) oracle: PlaneOracle,
}

impl Drop<'_> {
    /// Simulates one start orientation with one algorithm; a row a step.
    ///
    /// # Errors
    /// When the engine could not ask the algorithm: it would have gone on without contacts.
    pub(crate) fn simulate(
        &self,
        algorithm: &str,
        prepared: &Prepared,
        orientation: u32,
    ) -> Result<Vec<StepRow>, String> {
        let stopwatch = Arc::new(Stopwatch::default());
        let (mut world, body) = self.world(prepared, &stopwatch, orientation);
        let frequency = f64::from(self.experiment.world.frequency_hz);
        let mut rows = Vec::with_capacity(self.experiment.world.steps as usize);
        for step in 0..self.experiment.world.steps {
            let asked = *world.bodies[body].position();
            world.step();
            let queries = stopwatch.take();
            if queries.unsupported > 0 {
                return Err("the dispatcher does not support this pair of shapes".into());
            }
            let pairs = world.narrow_phase.contact_pairs();
            let manifolds = pairs.flat_map(|pair| pair.solver_manifolds().iter());
            let (contacts, penetration_m) = summary(manifolds);
            let body = &world.bodies[body];
            if !body.position().is_finite() {
                return Err(format!("the body left all bounds in step {step}"));
            }
            let (t, q) = (asked.translation, asked.rotation);
            rows.push(StepRow {
                algorithm: algorithm.into(),
                orientation,
                step,
                time_s: f64::from(step) / frequency,
                queries: queries.count,
                query_ns: queries.ns,
                contacts,
                penetration_m,
                true_penetration_m: self.oracle.penetration(&asked, 0.0),
                linear_velocity_m_s: body.linvel().length(),
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
        prepared: &Prepared,
        stopwatch: &Arc<Stopwatch>,
        orientation: u32,
    ) -> (PhysicsWorld, RigidBodyHandle) {
        let Experiment {
            body,
            ground,
            world: settings,
            ..
        } = self.experiment;
        let timed = Timed::new(prepared.dispatcher.clone(), stopwatch.clone());
        let mut world = PhysicsWorld {
            narrow_phase: NarrowPhase::with_query_dispatcher(timed),
            gravity: Vector::new(0.0, -settings.gravity_m_s2, 0.0),
            ..PhysicsWorld::default()
        };
        let parameters = &mut world.integration_parameters;
        parameters.dt = 1.0 / settings.frequency_hz;
        parameters.contact_recycling = false;
        parameters.contact_clustering = false;
        parameters.normalized_prediction_distance = settings.prediction_m / parameters.length_unit;

        let below = Vector::new(0.0, -0.5 * ground.extents_m[1] as f32, 0.0);
        let material = |shape: &SharedShape| {
            ColliderBuilder::new(shape.clone())
                .friction(body.friction)
                .restitution(body.restitution)
        };
        world.insert(
            RigidBodyBuilder::fixed().translation(below),
            material(&prepared.ground),
        );
        let rotation = self.start_orientation(orientation);
        let center = self.mass.center();
        let start = Vector::new(0.0, settings.drop_height_m, 0.0) - rotation * center;
        let inertia = self.mass.inertia_tensor(body.mass_kg);
        let mass = MassProperties::with_inertia_matrix(center, body.mass_kg, inertia);
        let falling = RigidBodyBuilder::dynamic()
            .pose(Pose::from_parts(start, rotation))
            .additional_mass_properties(mass)
            .can_sleep(false);
        // All mass is that of the solid, whatever an algorithm made of it.
        let (handle, _) = world.insert(falling, material(&prepared.body).density(0.0));
        (world, handle)
    }

    /// Uniformly distributed (Shoemake, 1992); the same for all algorithms.
    fn start_orientation(&self, orientation: u32) -> Quat {
        let seed = self
            .experiment
            .runs
            .seed
            .wrapping_add(u64::from(orientation));
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let [u, v, w]: [f32; 3] = rng.random();
        let (v, w) = (v * std::f32::consts::TAU, w * std::f32::consts::TAU);
        let (a, b) = ((1.0 - u).sqrt(), u.sqrt());
        Quat::from_xyzw(a * v.sin(), a * v.cos(), b * w.sin(), b * w.cos()).normalize()
    }
}
