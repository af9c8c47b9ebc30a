//! The check that a world handles VPS shapes.

use rapier3d::dynamics::IntegrationParameters;
use rapier3d::geometry::{ColliderHandle, ColliderSet, ContactManifold, NarrowPhase};
use rapier3d::math::{Pose, Real, Vector};
use rapier3d::parry::shape::{Shape, TriMesh};

use crate::precision::real;
use crate::shape::VpsShape;
use crate::warnings::{MAX_PREDICTION, REMEDY, without_warnings};

/// Motion of a pair for which its contacts are kept, relative to the diagonal of a shape, above which
/// bodies that fit closely pass through each other.
const MAX_RECYCLE_DISTANCE: Real = 0.1;

/// Why the VPS shapes of a world will not collide as they should. Lengths are in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum WorldError {
    /// A collider has a VPS shape, and the narrow phase has no dispatcher for it.
    MissingDispatcher {
        /// The first such collider.
        collider: ColliderHandle,
    },
    /// A VPS shape is small beside the distance for which contacts are kept.
    RecycleDistance {
        /// The first such collider.
        collider: ColliderHandle,
        /// The diagonal of its shape.
        size: Real,
        /// The distance for which contacts are kept.
        distance: Real,
    },
    /// A VPS shape is small beside the distance from which contacts are predicted.
    Prediction {
        /// The first such collider.
        collider: ColliderHandle,
        /// The diagonal of its shape.
        size: Real,
        /// The distance from which contacts are predicted.
        distance: Real,
    },
}

impl std::fmt::Display for WorldError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::MissingDispatcher { collider } => write!(
                f,
                "collider {collider:?} is a VPS shape, but the narrow phase has no dispatcher for it \
                 and it meets nothing: {REMEDY}"
            ),
            Self::RecycleDistance {
                collider,
                size,
                distance,
            } => write!(
                f,
                "collider {collider:?} is a VPS shape of {size} m, but contacts are kept until it has \
                 moved by {distance} m: {REMEDY}"
            ),
            Self::Prediction {
                collider,
                size,
                distance,
            } => write!(
                f,
                "collider {collider:?} is a VPS shape of {size} m, but contacts are predicted \
                 {distance} m ahead: {REMEDY}"
            ),
        }
    }
}

impl std::error::Error for WorldError {}

/// Checks that the VPS shapes of a world collide as they should, for the start of a program or a test.
/// rapier is silent about pairs its narrow phase cannot answer, and about tolerances that are large
/// beside a body. Costs a query for each VPS shape.
///
/// ```
/// use vps_rapier::rapier3d::prelude::*;
///
/// let mut world = PhysicsWorld::default();
/// vps_rapier::set_up(&mut world.narrow_phase, &mut world.integration_parameters, 0.2);
/// vps_rapier::check(&world.narrow_phase, &world.integration_parameters, &world.colliders)?;
/// # Ok::<(), vps_rapier::WorldError>(())
/// ```
///
/// # Errors
/// When a collider has a VPS shape, alone or in a compound, and
/// - the narrow phase does not support it or asks another dispatcher before ours,
/// - the distance for which contacts are kept is more than a tenth of the diagonal of its shape, or
/// - the distance from which contacts are predicted is more than half of it.
pub fn check(
    narrow_phase: &NarrowPhase,
    parameters: &IntegrationParameters,
    colliders: &ColliderSet,
) -> Result<(), WorldError> {
    let recycle_distance = if parameters.contact_recycling {
        parameters.contact_recycle_distance()
    } else {
        0.0
    };
    let prediction = parameters.prediction_distance();
    for (collider, shape) in colliders.iter().map(|(handle, c)| (handle, c.shape())) {
        let Some(vps) = vps_shape_in(shape) else {
            continue;
        };
        if !meets_meshes(narrow_phase, vps) {
            return Err(WorldError::MissingDispatcher { collider });
        }
        let size = shape.compute_local_aabb().extents().length();
        if recycle_distance > MAX_RECYCLE_DISTANCE * size {
            let distance = recycle_distance;
            return Err(WorldError::RecycleDistance {
                collider,
                size,
                distance,
            });
        }
        if prediction > real(MAX_PREDICTION) * size {
            let distance = prediction;
            return Err(WorldError::Prediction {
                collider,
                size,
                distance,
            });
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
    let found = without_warnings(|| {
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
