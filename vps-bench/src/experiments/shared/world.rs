//! Physics worlds that query contacts in every step in which two bounding boxes meet.

use std::sync::Arc;

use rapier3d::prelude::*;
use vps_compare::{Dispatcher, count_and_deepest};

use crate::harness::timed_dispatcher::{QueryTimes, Stopwatch, TimedDispatcher};

/// Gravity, step and prediction of a world.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StepSettings {
    pub(crate) gravity_m_s2: f64,
    pub(crate) frequency_hz: u32,
    /// The distance up to which contacts are predicted.
    pub(crate) prediction_m: f64,
}

/// A physics world and the times of its queries.
pub(crate) struct World {
    pub(crate) physics: PhysicsWorld,
    stopwatch: Arc<Stopwatch>,
}

impl StepSettings {
    /// An empty world without contact recycling and manifold clustering, which avoid queries.
    pub(crate) fn new_world(&self, dispatcher: &Arc<Dispatcher>) -> World {
        let stopwatch = Arc::new(Stopwatch::default());
        let timed = TimedDispatcher::new(dispatcher.clone(), stopwatch.clone());
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
    /// Adds a box whose upper side is at height 0.
    pub(crate) fn insert_ground(&mut self, ground: ColliderBuilder, extents_m: [f64; 3]) {
        let below = Vector::new(0.0, -0.5 * extents_m[1] as f32, 0.0);
        self.physics
            .insert(RigidBodyBuilder::fixed().translation(below), ground);
    }

    /// Adds a body with the given mass and inertia, independent of the shape an algorithm made.
    pub(crate) fn insert_body(
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

    /// The number of contact points given to the solver in the last step, and the deepest
    /// penetration.
    pub(crate) fn contacts(&self) -> (usize, Option<f32>) {
        let pairs = self.physics.narrow_phase.contact_pairs();
        count_and_deepest(pairs.flat_map(|pair| pair.solver_manifolds().iter()))
    }

    /// Steps once and returns the times of the queries.
    ///
    /// # Errors
    /// When the algorithm does not support the pair: the engine would go on without contacts.
    pub(crate) fn step(&mut self) -> Result<QueryTimes, String> {
        self.physics.step();
        let queries = self.stopwatch.take();
        if queries.unsupported > 0 {
            return Err("the dispatcher does not support this pair of shapes".into());
        }
        Ok(queries)
    }
}
