//! Worlds with VPS shapes in files: a whole world, or the shapes of its colliders ([`shape_snapshot`]).

mod exchange;
pub(crate) mod shape_snapshot;

use rapier3d::parry::query::{DefaultQueryDispatcher, QueryDispatcher};
use rapier3d::pipeline::PhysicsWorld;
use serde::{Deserialize, Serialize};

use self::shape_snapshot::ShapeSnapshot;
use crate::dispatcher::VpsDispatcher;
use crate::shape::builder::ShapeError;

/// A whole world with VPS shapes, for serde to write and to read.
///
/// rapier cannot write custom shapes, and a narrow phase that was read has lost its dispatcher. A
/// snapshot keeps VPS shapes, also those in compounds, by the files of their assets, or the assets
/// themselves if they have no file. A restored world continues bit for bit as the original would,
/// wherever rapier's own worlds do: not with contact clustering, whose last clusters rapier does not
/// write.
///
/// ```
/// use vps_rapier::Snapshot;
/// use vps_rapier::rapier3d::prelude::*;
///
/// # let world = PhysicsWorld::default();
/// let text = serde_json::to_string(&Snapshot::of(&world))?;
///
/// let snapshot: Snapshot = serde_json::from_str(&text)?;
/// let world = snapshot.restore()?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Serialize, Deserialize)]
pub struct Snapshot {
    world: PhysicsWorld,
    shapes: ShapeSnapshot,
}

impl Snapshot {
    /// Takes a snapshot of a world, which is not changed.
    pub fn of(world: &PhysicsWorld) -> Self {
        let mut colliders = world.colliders.clone();
        let shapes = ShapeSnapshot::extract(&mut colliders, &world.bodies);
        let world = PhysicsWorld {
            gravity: world.gravity,
            integration_parameters: world.integration_parameters,
            islands: world.islands.clone(),
            broad_phase: world.broad_phase.clone(),
            narrow_phase: world.narrow_phase.clone(),
            bodies: world.bodies.clone(),
            colliders,
            impulse_joints: world.impulse_joints.clone(),
            multibody_joints: world.multibody_joints.clone(),
            soft_bodies: world.soft_bodies.clone(),
            ..PhysicsWorld::default()
        };
        Self { world, shapes }
    }

    /// The world, its narrow phase with the default [`VpsDispatcher`]. If it had another dispatcher, set
    /// that by `set_query_dispatcher`.
    ///
    /// # Errors
    /// When the file of an asset cannot be read, or an asset in the snapshot is not valid.
    pub fn restore(self) -> Result<PhysicsWorld, ShapeError> {
        let mut world = self.world;
        self.shapes.restore(&mut world.colliders, &world.bodies)?;
        let dispatcher = VpsDispatcher::default().chain(DefaultQueryDispatcher);
        world.narrow_phase.set_query_dispatcher(dispatcher);
        Ok(world)
    }
}
