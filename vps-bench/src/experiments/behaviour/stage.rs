//! A world, stepped and watched.

use std::time::{Duration, Instant};

use rapier3d::parry::query::{DefaultQueryDispatcher, QueryDispatcher};
use rapier3d::prelude::*;
use vps_core::{Body, BodyPair, Query, Shells};
use vps_rapier::{Manifolds, VpsDispatcher};

use super::collider::Collider;
use super::models::{Model, ModelName};
use super::persistence::Persistence;
use super::setup::Setup;

/// Friction and restitution of all bodies of a scene.
#[derive(Clone, Copy, Debug)]
pub(super) struct Material {
    pub(super) friction: f32,
    pub(super) restitution: f32,
}

/// The material of most scenes.
pub(super) const PLAIN: Material = Material {
    friction: 0.5,
    restitution: 0.0,
};

/// Steps between two measurements of how deep bodies are.
const LOOK_EVERY: u32 = 5;

/// A world of bodies that all collide as one kind of shape.
pub(super) struct Stage<'s> {
    pub(super) world: PhysicsWorld,
    setup: &'s Setup,
    material: Material,
    bodies: Vec<(RigidBodyHandle, &'s Model)>,
    boxes: Vec<(Pose, vps_core::Cuboid)>,
    /// Steps made.
    pub(super) steps: u32,
    /// Whether all requested steps were made.
    pub(super) is_complete: bool,
    stepping: Duration,
    limit: Duration,
    /// The deepest any body has been in another, in metres.
    pub(super) deepest_m: f32,
    pub(super) persistence: Persistence,
}

/// How still bodies are that should be at rest.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Rest {
    /// The largest displacement of a centre in metres.
    pub(super) drift_m: f32,
    /// The highest speed of any part of a body, bounded from above, in m/s.
    pub(super) speed_m_s: f32,
    /// The highest kinetic energy of all bodies together in J.
    pub(super) energy_j: f32,
    /// The depth of the deepest at the end, in metres.
    pub(super) deepest_m: f32,
}

impl<'s> Stage<'s> {
    /// An empty world; y is up.
    pub(super) fn new(setup: &'s Setup, frequency_hz: f32, material: Material) -> Self {
        let mut world = PhysicsWorld::default();
        if setup.collider.is_vps() {
            world.narrow_phase = vps_rapier::narrow_phase();
        }
        if setup.collider == Collider::VpsSegments {
            let dispatcher = VpsDispatcher {
                manifolds: Manifolds::Segments(setup.segments_level),
                ..VpsDispatcher::default()
            };
            let dispatcher = dispatcher.chain(DefaultQueryDispatcher);
            world.narrow_phase = NarrowPhase::with_query_dispatcher(dispatcher);
            // It would join them again.
            world.integration_parameters.contact_clustering = false;
        }
        let parameters = &mut world.integration_parameters;
        parameters.dt = 1.0 / frequency_hz;
        setup.set_recycling(parameters);
        Self {
            world,
            setup,
            material,
            bodies: Vec::new(),
            boxes: Vec::new(),
            steps: 0,
            is_complete: true,
            stepping: Duration::ZERO,
            limit: Duration::from_secs(12),
            deepest_m: 0.0,
            persistence: Persistence::default(),
        }
    }

    /// Stops after this time spent on steps.
    pub(super) fn with_limit(self, seconds: u64) -> Self {
        Self {
            limit: Duration::from_secs(seconds),
            ..self
        }
    }

    /// A fixed box with these edges in metres.
    pub(super) fn add_box(&mut self, extents: [f32; 3], pose: Pose) {
        let [x, y, z] = extents.map(|e| 0.5 * e);
        let collider = self.collider_builder(SharedShape::cuboid(x, y, z));
        self.world
            .insert(RigidBodyBuilder::fixed().pose(pose), collider);
        self.boxes
            .push((pose, vps_core::Cuboid::new(Vector::new(x, y, z))));
    }

    /// A box 0.2 m thick with its upper side at height 0.
    pub(super) fn add_ground(&mut self) {
        self.add_box([4.0, 0.2, 4.0], Pose::translation(0.0, -0.1, 0.0));
    }

    /// A body, its mass that of the solid whatever it collides as.
    ///
    /// # Errors
    /// When the model or its shape cannot be made.
    pub(super) fn add(
        &mut self,
        name: ModelName,
        body: RigidBodyBuilder,
    ) -> Result<RigidBodyHandle, String> {
        let model = self.setup.model(name)?;
        let mut body = body
            .additional_mass_properties(model.mass())
            .can_sleep(false)
            .build();
        if body.is_dynamic() {
            let aside = self.setup.aside(self.bodies.len(), model.reach());
            let start = Pose::from_parts(
                body.translation() + aside.translation,
                aside.rotation * *body.rotation(),
            );
            body.set_position(start, false);
        }
        let collider = self.collider_builder(model.shape(self.setup.collider)?);
        let (handle, _) = self.world.insert(body, collider);
        self.bodies.push((handle, model));
        Ok(handle)
    }

    fn collider_builder(&self, shape: SharedShape) -> ColliderBuilder {
        ColliderBuilder::new(shape)
            .density(0.0)
            .friction(self.material.friction)
            .restitution(self.material.restitution)
    }

    pub(super) fn body(&self, handle: RigidBodyHandle) -> &RigidBody {
        &self.world.bodies[handle]
    }

    /// Frequency of steps in Hz.
    pub(super) fn frequency_hz(&self) -> f32 {
        1.0 / self.world.integration_parameters.dt
    }

    /// Steps for a time in seconds, or until `is_over` after a step; `false` if the limit was reached
    /// before, or a body left all bounds.
    pub(super) fn run(&mut self, seconds: f32, mut is_over: impl FnMut(&Self) -> bool) -> bool {
        let steps = (seconds * self.frequency_hz()).round() as u32;
        for _ in 0..steps {
            if self.stepping >= self.limit || !self.is_sound() {
                self.is_complete = false;
                return false;
            }
            let start = Instant::now();
            self.world.step();
            self.stepping += start.elapsed();
            self.steps += 1;
            self.persistence.follow(&self.world);
            if self.steps.is_multiple_of(LOOK_EVERY) {
                self.deepest_m = self.deepest_m.max(self.depth());
            }
            if is_over(self) {
                break;
            }
        }
        true
    }

    /// Steps for a time in seconds.
    pub(super) fn go(&mut self, seconds: f32) -> bool {
        self.run(seconds, |_| false)
    }

    /// Steps for a time in seconds in which bodies should be at rest; `None` if the limit was reached.
    pub(super) fn watch(&mut self, seconds: f32) -> Option<Rest> {
        let before = self.centers();
        let mut rest = Rest::default();
        let is_complete = self.run(seconds, |stage| {
            rest.speed_m_s = rest.speed_m_s.max(stage.speed());
            rest.energy_j = rest.energy_j.max(stage.energy());
            false
        });
        rest.deepest_m = self.depth();
        let moved = self.centers().into_iter().zip(before);
        rest.drift_m = moved
            .map(|(now, then)| now.distance(then))
            .fold(0.0, f32::max);
        is_complete.then_some(rest)
    }

    /// Mean speed of all steps in steps a second.
    pub(super) fn steps_per_s(&self) -> f64 {
        f64::from(self.steps) / self.stepping.as_secs_f64()
    }

    /// Time taken by steps.
    pub(super) fn stepping_s(&self) -> f64 {
        self.stepping.as_secs_f64()
    }

    /// All bodies that are models.
    pub(super) fn models(&self) -> impl Iterator<Item = (&RigidBody, &'s Model)> {
        self.bodies
            .iter()
            .map(|&(handle, model)| (&self.world.bodies[handle], model))
    }

    fn is_sound(&self) -> bool {
        self.models().all(|(body, _)| body.position().is_finite())
    }

    fn centers(&self) -> Vec<Vector> {
        self.models()
            .map(|(body, _)| body.center_of_mass())
            .collect()
    }

    /// A bound on the speed of all parts of all bodies in m/s.
    pub(super) fn speed(&self) -> f32 {
        self.models()
            .map(|(body, model)| body.linvel().length() + body.angvel().length() * model.reach())
            .fold(0.0, f32::max)
    }

    fn energy(&self) -> f32 {
        self.models().map(|(body, _)| body.kinetic_energy()).sum()
    }

    /// How deep the deepest point of a body is in another, in metres; 0 if all are apart. By shells
    /// and voxelmaps of all bodies, whatever they collide as.
    pub(super) fn depth(&self) -> f32 {
        let bodies: Vec<_> = self.models().collect();
        let mut deepest = 0.0_f32;
        for (i, (a, model_a)) in bodies.iter().enumerate() {
            for (b, model_b) in &bodies[i + 1..] {
                let apart = a.center_of_mass().distance(b.center_of_mass());
                if apart > model_a.reach() + model_b.reach() || a.is_fixed() && b.is_fixed() {
                    continue;
                }
                let [in_a, in_b] = [model_a, model_b].map(|m| Body::of_asset(&m.asset));
                let b_to_a = a.position().inv_mul(b.position());
                let pair = BodyPair::new(in_a, in_b, b_to_a).with_shells(Shells::Both);
                deepest = deepest.max(pair.deepest().map_or(0.0, |c| c.penetration));
            }
            if a.is_fixed() {
                continue;
            }
            for (pose, cuboid) in &self.boxes {
                let to_box = pose.inv_mul(a.position());
                let contact = Query::new(&model_a.asset.tree, cuboid, to_box).deepest();
                deepest = deepest.max(contact.map_or(0.0, |c| c.penetration));
            }
        }
        deepest
    }
}
