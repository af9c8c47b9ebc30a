//! Whether a world knows what to do with VPS shapes.

use std::sync::atomic::{AtomicBool, Ordering};

use rapier3d::geometry::{ColliderHandle, ColliderSet, NarrowPhase};
use rapier3d::math::{Pose, Vector};
use rapier3d::parry::shape::{Cuboid, Shape};

use crate::VpsShape;

/// A collider has a VPS shape, and the narrow phase no dispatcher for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NoDispatcher(
    /// The first such collider.
    pub ColliderHandle,
);

impl std::fmt::Display for NoDispatcher {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self(collider) = self;
        write!(
            f,
            "collider {collider:?} is a VPS shape, but the narrow phase has no dispatcher for it and \
             it meets nothing: {REMEDY}"
        )
    }
}

impl std::error::Error for NoDispatcher {}

const REMEDY: &str = "make the world with `narrow_phase: vps_rapier::narrow_phase()`";

/// Checks that the VPS shapes of a world meet other shapes, for the start of a program or a test:
/// rapier says nothing about pairs its narrow phase cannot answer.
///
/// ```
/// use vps_rapier::rapier3d::prelude::*;
///
/// let world = PhysicsWorld { narrow_phase: vps_rapier::narrow_phase(), ..PhysicsWorld::default() };
/// vps_rapier::check(&world.narrow_phase, &world.colliders)?;
/// # Ok::<(), vps_rapier::NoDispatcher>(())
/// ```
///
/// # Errors
/// When a collider has a VPS shape, alone or in a compound, that the narrow phase knows nothing about.
pub fn check(narrow_phase: &NarrowPhase, colliders: &ColliderSet) -> Result<(), NoDispatcher> {
    let dispatcher = narrow_phase.query_dispatcher();
    // Not a ball, which parry's own dispatcher can tell from any shape points can be projected on.
    let other = Cuboid::new(Vector::splat(1.0));
    let far = Pose::from_translation(Vector::splat(1e6));
    for (handle, collider) in colliders.iter() {
        if let Some(shape) = vps_shape_in(collider.shape())
            && dispatcher.intersection_test(&far, shape, &other).is_err()
        {
            return Err(NoDispatcher(handle));
        }
    }
    Ok(())
}

/// A VPS shape, or the first one among the parts of a compound.
fn vps_shape_in(shape: &dyn Shape) -> Option<&VpsShape> {
    let parts = shape.as_compound().map_or(&[][..], |c| c.shapes());
    let mut parts = parts.iter().filter_map(|(_, part)| part.as_shape());
    shape.as_shape().or_else(|| parts.next())
}

/// Whether a dispatcher of ours was ever asked anything.
static IS_CONNECTED: AtomicBool = AtomicBool::new(false);

/// Whether it was said once that none was.
static IS_WARNED: AtomicBool = AtomicBool::new(false);

/// To be called by a dispatcher that is asked something.
pub(crate) fn connected() {
    if !IS_CONNECTED.load(Ordering::Relaxed) {
        IS_CONNECTED.store(true, Ordering::Relaxed);
    }
}

/// To be called by a VPS shape that parry's own dispatcher asks for its faces. Ours keeps it from
/// that, so that a world without it is the likely reason; said once in a process, by the `log` crate
/// if the program logs warnings, and on standard error otherwise.
pub(crate) fn asked_for_faces() {
    if IS_CONNECTED.load(Ordering::Relaxed) || IS_WARNED.swap(true, Ordering::Relaxed) {
        return;
    }
    let warning = "parry's own dispatcher was asked for contacts of a VPS shape and has none";
    if log::log_enabled!(log::Level::Warn) {
        log::warn!("{warning}: {REMEDY}");
    } else {
        eprintln!("vps-rapier: {warning}: {REMEDY}");
    }
}
