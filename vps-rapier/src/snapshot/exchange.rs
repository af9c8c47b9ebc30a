//! The exchange of shapes in a world that rapier does not see as a change.

use std::collections::HashSet;

use rapier3d::dynamics::{IslandManager, RigidBodySet};
use rapier3d::geometry::{BroadPhaseBvh, ColliderHandle, ColliderSet, NarrowPhase, SharedShape};
use rapier3d::pipeline::CollisionPipeline;

use crate::warnings::without_warnings;

/// A compound with some of its parts replaced; the shape itself if it is not a compound.
pub(super) fn replace_parts(
    shape: &SharedShape,
    mut replacement: impl FnMut(usize, &SharedShape) -> Option<SharedShape>,
) -> SharedShape {
    let Some(compound) = shape.as_compound() else {
        return shape.clone();
    };
    let parts = compound.shapes().iter().enumerate();
    let parts =
        parts.map(|(i, (pose, part))| (*pose, replacement(i, part).unwrap_or(part.clone())));
    SharedShape::compound(parts.collect())
}

/// Exchanges the shapes of colliders without marking them as changed, by which rapier would wake bodies
/// and search for their contacts anew. A step of the collision pipeline clears such marks, and is done
/// to a copy. Colliders that were marked before stay marked.
pub(super) fn exchange_shapes(
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
    without_warnings(|| {
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
