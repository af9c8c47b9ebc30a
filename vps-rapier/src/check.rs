//! The check that a world handles VPS shapes.

use rapier3d::geometry::{ColliderHandle, ColliderSet, ContactManifold, NarrowPhase};
use rapier3d::math::{Pose, Real, Vector};
use rapier3d::parry::shape::{Shape, TriMesh};

use crate::connection::{REMEDY, without_warning};
use crate::shape::VpsShape;

/// A collider has a VPS shape, and the narrow phase has no dispatcher for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MissingDispatcher(
    /// The first such collider.
    pub ColliderHandle,
);

impl std::fmt::Display for MissingDispatcher {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self(collider) = self;
        write!(
            f,
            "collider {collider:?} is a VPS shape, but the narrow phase has no dispatcher for it and \
             it meets nothing: {REMEDY}"
        )
    }
}

impl std::error::Error for MissingDispatcher {}

/// Checks that the VPS shapes of a world meet other shapes, for the start of a program or a test.
/// rapier is silent about pairs its narrow phase cannot answer. Costs a query for each VPS shape.
///
/// ```
/// use vps_rapier::rapier3d::prelude::*;
///
/// let world = PhysicsWorld { narrow_phase: vps_rapier::narrow_phase(), ..PhysicsWorld::default() };
/// vps_rapier::check(&world.narrow_phase, &world.colliders)?;
/// # Ok::<(), vps_rapier::MissingDispatcher>(())
/// ```
///
/// # Errors
/// When a collider has a VPS shape, alone or in a compound, and the narrow phase does not support it or
/// asks another dispatcher before ours.
pub fn check(narrow_phase: &NarrowPhase, colliders: &ColliderSet) -> Result<(), MissingDispatcher> {
    for (handle, collider) in colliders.iter() {
        if let Some(shape) = vps_shape_in(collider.shape())
            && !meets_meshes(narrow_phase, shape)
        {
            return Err(MissingDispatcher(handle));
        }
    }
    Ok(())
}

/// Whether a shape has contacts with a triangle through its middle. parry's own dispatcher claims to
/// support all pairs with meshes and finds nothing, so that ours is not asked if it comes behind.
fn meets_meshes(narrow_phase: &NarrowPhase, shape: &VpsShape) -> bool {
    let bounds = shape.compute_local_aabb();
    let (middle, reach) = (bounds.center(), bounds.extents().length());
    let corner = |x: Real, z: Real| middle + Vector::new(x, 0.0, z) * (4.0 * reach);
    let corners = vec![corner(-1.0, -1.0), corner(0.0, 1.0), corner(1.0, -1.0)];
    let Ok(triangle) = TriMesh::new(corners, vec![[0, 1, 2]]) else {
        return false;
    };
    let mut manifolds: Vec<ContactManifold> = Vec::new();
    let found = without_warning(|| {
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

/// The shape itself if it is a VPS shape, or the first one among the parts of a compound.
fn vps_shape_in(shape: &dyn Shape) -> Option<&VpsShape> {
    let parts = shape.as_compound().map_or(&[][..], |c| c.shapes());
    let mut parts = parts.iter().filter_map(|(_, part)| part.as_shape());
    shape.as_shape().or_else(|| parts.next())
}
