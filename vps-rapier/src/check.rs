//! Whether a world knows what to do with VPS shapes.

use std::sync::atomic::{AtomicBool, Ordering};

use rapier3d::geometry::{ColliderHandle, ColliderSet, ContactManifold, NarrowPhase};
use rapier3d::math::{Pose, Real, Vector};
use rapier3d::parry::shape::{Shape, TriMesh};

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
/// rapier says nothing about pairs its narrow phase cannot answer. Costs a query for each VPS shape.
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
/// When a collider has a VPS shape, alone or in a compound, that the narrow phase knows nothing about,
/// or leaves to another dispatcher that comes before ours.
pub fn check(narrow_phase: &NarrowPhase, colliders: &ColliderSet) -> Result<(), NoDispatcher> {
    for (handle, collider) in colliders.iter() {
        if let Some(shape) = vps_shape_in(collider.shape())
            && !meets_meshes(narrow_phase, shape)
        {
            return Err(NoDispatcher(handle));
        }
    }
    Ok(())
}

/// Whether a shape has contacts with a triangle through the middle of it: parry's own dispatcher says
/// of meshes that it knows all pairs with them, and finds nothing, so that one of ours that comes
/// behind it is not asked.
fn meets_meshes(narrow_phase: &NarrowPhase, shape: &VpsShape) -> bool {
    let bounds = shape.compute_local_aabb();
    let (middle, reach) = (bounds.center(), bounds.extents().length());
    let corner = |x: Real, z: Real| middle + Vector::new(x, 0.0, z) * (4.0 * reach);
    let corners = vec![corner(-1.0, -1.0), corner(0.0, 1.0), corner(1.0, -1.0)];
    let Ok(triangle) = TriMesh::new(corners, vec![[0, 1, 2]]) else {
        return false;
    };
    let mut manifolds: Vec<ContactManifold> = Vec::new();
    let found = quietly(|| {
        narrow_phase.query_dispatcher().contact_manifolds(
            &Pose::IDENTITY,
            shape,
            &triangle,
            reach,
            &mut manifolds,
            &mut None,
        )
    });
    found.is_ok() && manifolds.iter().any(|m| !m.points.is_empty())
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

/// Whether pairs are looked at whose contacts nobody wants.
static IS_QUIET: AtomicBool = AtomicBool::new(false);

/// Does something in which it does not matter that no dispatcher of ours is asked.
pub(crate) fn quietly<T>(something: impl FnOnce() -> T) -> T {
    IS_QUIET.store(true, Ordering::Relaxed);
    let result = something();
    IS_QUIET.store(false, Ordering::Relaxed);
    result
}

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
    if IS_CONNECTED.load(Ordering::Relaxed)
        || IS_QUIET.load(Ordering::Relaxed)
        || IS_WARNED.swap(true, Ordering::Relaxed)
    {
        return;
    }
    let warning = "parry's own dispatcher was asked for contacts of a VPS shape and has none";
    if log::log_enabled!(log::Level::Warn) {
        log::warn!("{warning}: {REMEDY}");
    } else {
        eprintln!("vps-rapier: {warning}: {REMEDY}");
    }
}
