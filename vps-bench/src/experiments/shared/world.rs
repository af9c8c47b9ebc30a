//! Worlds in which an engine asks whenever two boxes meet.

use std::sync::Arc;

use rapier3d::prelude::*;
use vps_compare::{Dispatcher, summary};

use crate::timed::{Queries, Stopwatch, Timed};

/// How a world steps.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stepping {
    pub(super) gravity_m_s2: f64,
    pub(super) frequency_hz: u32,
    /// How far ahead contacts are found.
    pub(super) prediction_m: f64,
}

/// A world, and what its queries took.
pub(super) struct World {
    pub(super) physics: PhysicsWorld,
    stopwatch: Arc<Stopwatch>,
}

impl Stepping {
    /// An empty world without what avoids queries: recycled contacts and merged manifolds.
    pub(super) fn world(&self, dispatcher: &Arc<Dispatcher>) -> World {
        let stopwatch = Arc::new(Stopwatch::default());
        let timed = Timed::new(dispatcher.clone(), stopwatch.clone());
        let mut physics = PhysicsWorld {
            narrow_phase: NarrowPhase::with_query_dispatcher(timed),
            gravity: Vector::new(0.0, -self.gravity_m_s2 as f32, 0.0),
            ..PhysicsWorld::default()
        };
        let parameters = &mut physics.integration_parameters;
        parameters.dt = 1.0 / self.frequency_hz as f32;
        parameters.contact_recycling = false;
        parameters.contact_clustering = false;
        parameters.normalized_prediction_distance =
            self.prediction_m as f32 / parameters.length_unit;
        World { physics, stopwatch }
    }
}

impl World {
    /// Adds a box of which the upper side is at height 0.
    pub(super) fn insert_ground(&mut self, ground: ColliderBuilder, extents_m: [f64; 3]) {
        let below = Vector::new(0.0, -0.5 * extents_m[1] as f32, 0.0);
        self.physics
            .insert(RigidBodyBuilder::fixed().translation(below), ground);
    }

    /// Adds a body of a mass, with an inertia about its centre of mass, whatever an algorithm made
    /// of its shape.
    pub(super) fn insert_body(
        &mut self,
        collider: ColliderBuilder,
        pose: Pose,
        mass: MassProperties,
    ) -> RigidBodyHandle {
        let builder = RigidBodyBuilder::dynamic()
            .pose(pose)
            .additional_mass_properties(mass)
            .can_sleep(false);
        self.physics.insert(builder, collider.density(0.0)).0
    }

    /// Contact points given to the solver in the last step, and the deepest of them.
    pub(super) fn contacts(&self) -> (usize, Option<f32>) {
        let pairs = self.physics.narrow_phase.contact_pairs();
        summary(pairs.flat_map(|pair| pair.solver_manifolds().iter()))
    }

    /// Steps once; gives what its queries took.
    ///
    /// # Errors
    /// When the engine could not ask the algorithm: it would go on without contacts.
    pub(super) fn step(&mut self) -> Result<Queries, String> {
        self.physics.step();
        let queries = self.stopwatch.take();
        if queries.unsupported > 0 {
            return Err("the dispatcher does not support this pair of shapes".into());
        }
        Ok(queries)
    }
}
