//! Worlds with VPS shapes in files.

use std::collections::{HashMap, HashSet};
use std::path::PathBuf;
use std::sync::Arc;

use rapier3d::dynamics::{IslandManager, RigidBodySet};
use rapier3d::geometry::{BroadPhaseBvh, ColliderHandle, ColliderSet, NarrowPhase, SharedShape};
use rapier3d::parry::query::{DefaultQueryDispatcher, QueryDispatcher};
use rapier3d::pipeline::{CollisionPipeline, PhysicsWorld};
use serde::{Deserialize, Serialize};
use vps_core::{Asset, encode};

use crate::check::quietly;
use crate::{Role, ShapeError, VpsDispatcher, VpsShape};

/// A whole world with VPS shapes, for serde to write and to read.
///
/// rapier cannot write shapes it does not know, nor does a narrow phase that was read know its
/// dispatcher. A snapshot keeps VPS shapes, also those in compounds, by the files of their assets, or
/// the assets themselves if they are in no file. The world that comes out of it goes on as the one it
/// was taken of, to the bit, if rapier's own does: not with contact clustering, whose last clusters
/// rapier does not write.
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
    shapes: SavedShapes,
}

impl Snapshot {
    /// Of a world as it is, which stays so.
    pub fn of(world: &PhysicsWorld) -> Self {
        let mut colliders = world.colliders.clone();
        let shapes = SavedShapes::take_out(&mut colliders, &world.bodies);
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

    /// The world, its narrow phase with the default [`VpsDispatcher`]; give it another one by
    /// `set_query_dispatcher` if it had another.
    ///
    /// # Errors
    /// When the file of an asset cannot be read, or an asset in the snapshot is not sound.
    pub fn restore(self) -> Result<PhysicsWorld, ShapeError> {
        let mut world = self.world;
        self.shapes.put_back(&mut world.colliders, &world.bodies)?;
        let dispatcher = VpsDispatcher::default().chain(DefaultQueryDispatcher);
        world.narrow_phase.set_query_dispatcher(dispatcher);
        Ok(world)
    }
}

/// The VPS shapes of colliders, for those who keep the parts of a world apart; see [`Snapshot`].
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SavedShapes {
    assets: Vec<SavedAsset>,
    shapes: Vec<SavedShape>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
enum SavedAsset {
    File(PathBuf),
    /// The bytes of a `.vps` file.
    Bytes(Vec<u8>),
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct SavedShape {
    collider: ColliderHandle,
    /// Which part of a compound it is.
    part: Option<usize>,
    /// Position among the assets.
    asset: usize,
    role: Role,
}

impl SavedShapes {
    /// Puts a small ball in the place of each VPS shape. rapier does not take that for a change.
    pub fn take_out(colliders: &mut ColliderSet, bodies: &RigidBodySet) -> Self {
        let mut saved = Self::default();
        let mut numbers = HashMap::new();
        let mut without = Vec::new();
        for (handle, collider) in colliders.iter() {
            let mut take = |shape: &SharedShape, part| {
                let vps = shape.as_shape::<VpsShape>()?;
                let place: *const Asset<'_> = vps.asset();
                let asset = *numbers.entry(place).or_insert_with(|| {
                    saved.assets.push(match vps.file() {
                        Some(file) => SavedAsset::File(file.into()),
                        None => SavedAsset::Bytes(encode(vps.asset())),
                    });
                    saved.assets.len() - 1
                });
                saved.shapes.push(SavedShape {
                    collider: handle,
                    part,
                    asset,
                    role: vps.role(),
                });
                Some(SharedShape::ball(1e-3))
            };
            let shape = collider.shared_shape();
            if let Some(ball) = take(shape, None) {
                without.push((handle, ball));
            } else if crate::compound::compound_of_vps(&**shape).is_some() {
                without.push((handle, with_parts(shape, |i, part| take(part, Some(i)))));
            }
        }
        exchange(colliders, bodies, without);
        saved
    }

    /// Reads each asset once and gives the colliders their shapes; those that are gone are left out.
    /// rapier does not take that for a change.
    ///
    /// # Errors
    /// When an asset cannot be read; then nothing is changed.
    pub fn put_back(
        &self,
        colliders: &mut ColliderSet,
        bodies: &RigidBodySet,
    ) -> Result<(), ShapeError> {
        let read = self.assets.iter().map(SavedAsset::read);
        let read: Vec<VpsShape> = read.collect::<Result<_, _>>()?;
        let mut with: Vec<(ColliderHandle, SharedShape)> = Vec::new();
        for saved in &self.shapes {
            let shape = read.get(saved.asset).zip(colliders.get(saved.collider));
            let Some((shape, collider)) = shape else {
                continue;
            };
            let shape: SharedShape = shape.clone().with_role(saved.role).into();
            let Some(part) = saved.part else {
                with.push((saved.collider, shape));
                continue;
            };
            if with
                .last()
                .is_none_or(|(handle, _)| *handle != saved.collider)
            {
                with.push((saved.collider, collider.shared_shape().clone()));
            }
            if let Some((_, compound)) = with.last_mut() {
                *compound = with_parts(compound, |i, _| (i == part).then(|| shape.clone()));
            }
        }
        exchange(colliders, bodies, with);
        Ok(())
    }
}

impl SavedAsset {
    fn read(&self) -> Result<VpsShape, ShapeError> {
        match self {
            Self::File(file) => VpsShape::from_file(file),
            Self::Bytes(bytes) => {
                // An asset is used in place, which wants it at a multiple of 8.
                let mut words = vec![0_u64; bytes.len().div_ceil(8)];
                let aligned = &mut bytemuck::cast_slice_mut(&mut words)[..bytes.len()];
                aligned.copy_from_slice(bytes);
                let asset = Asset::from_bytes(aligned)?.into_owned();
                Ok(VpsShape::new(Arc::new(asset)))
            }
        }
    }
}

/// A compound with some of its parts exchanged; the shape itself if it is none.
fn with_parts(
    shape: &SharedShape,
    mut other: impl FnMut(usize, &SharedShape) -> Option<SharedShape>,
) -> SharedShape {
    let Some(compound) = shape.as_compound() else {
        return shape.clone();
    };
    let parts = compound.shapes().iter().enumerate();
    let parts = parts.map(|(i, (pose, part))| (*pose, other(i, part).unwrap_or(part.clone())));
    SharedShape::compound(parts.collect())
}

/// Exchanges the shapes of colliders without a mark that they changed, by which rapier would wake
/// bodies and find their contacts anew. Marks go where changes have been looked at, which is done to a
/// copy; what was changed before stays so.
fn exchange(
    colliders: &mut ColliderSet,
    bodies: &RigidBodySet,
    shapes: Vec<(ColliderHandle, SharedShape)>,
) {
    if shapes.is_empty() {
        return;
    }
    let mut copy = colliders.clone();
    let changed: HashSet<_> = copy.take_modified().iter().copied().collect();
    copy.take_removed();
    let mut unmarked = Vec::new();
    for (handle, shape) in shapes {
        let is_changed = changed.contains(&handle);
        let set = if is_changed {
            &mut *colliders
        } else {
            &mut copy
        };
        if let Some(collider) = set.get_mut(handle) {
            collider.set_shape(shape);
        }
        if !is_changed {
            unmarked.push(handle);
        }
    }
    quietly(|| {
        CollisionPipeline::new().step(
            0.0,
            &mut IslandManager::new(),
            &mut BroadPhaseBvh::default(),
            &mut NarrowPhase::new(),
            &mut bodies.clone(),
            &mut copy,
            &(),
            &(),
        );
    });
    for handle in unmarked {
        if let (Some(collider), Some(exchanged)) = (colliders.get_mut(handle), copy.get(handle)) {
            *collider = exchanged.clone();
        }
    }
    if changed.is_empty() {
        colliders.take_modified();
    }
}
