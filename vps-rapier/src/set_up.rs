//! Settings of a world for VPS shapes.

use rapier3d::dynamics::IntegrationParameters;
use rapier3d::geometry::NarrowPhase;
use rapier3d::math::Real;
use rapier3d::parry::query::{DefaultQueryDispatcher, QueryDispatcher};

use crate::dispatcher::VpsDispatcher;

/// Length unit of a world, in sizes of its smallest body. A body of 0.25 m has rapier's own unit of a
/// metre, with contacts predicted 20 mm ahead.
const LENGTH_UNIT: Real = 4.0;

/// Motion of a pair, in sizes of the smallest body, below which its contacts are kept.
const RECYCLE_DISTANCE: Real = 0.01;

/// Sets a world up for VPS shapes that move.
///
/// `size` is the longest side in metres of the smallest body that moves. Three things are set:
/// - The narrow phase gets the dispatcher of [`narrow_phase`].
/// - Contacts of a pair are kept until it has moved by a hundredth of `size`. By default rapier keeps
///   them for 50 mm: a nut of that size falls through its bolt.
/// - The length unit, on which all tolerances of rapier depend, is at most four times `size`. The
///   greatest speed of a body stays as it is.
///
/// Settings that are tighter stay. A world in other units than metres needs its `length_unit` set
/// before, and `size` in its units. May be called between any two steps.
///
/// # Panics
/// If `size` is not positive.
///
/// ```
/// use vps_rapier::rapier3d::prelude::*;
///
/// let mut world = PhysicsWorld::default();
/// vps_rapier::set_up(&mut world.narrow_phase, &mut world.integration_parameters, 0.05);
/// assert!((world.integration_parameters.contact_recycle_distance() - 0.0005).abs() < 1e-7);
/// assert!((world.integration_parameters.prediction_distance() - 0.004).abs() < 1e-7);
/// ```
pub fn set_up(narrow_phase: &mut NarrowPhase, parameters: &mut IntegrationParameters, size: Real) {
    assert!(size > 0.0, "a size of {size} m is not positive");
    narrow_phase.set_query_dispatcher(VpsDispatcher::default().chain(DefaultQueryDispatcher));
    let recycle_distance = parameters.contact_recycle_distance();
    let max_speed = parameters.max_linear_velocity();
    let length_unit = parameters.length_unit.min(LENGTH_UNIT * size);
    parameters.length_unit = length_unit;
    parameters.normalized_contact_recycle_distance =
        recycle_distance.min(RECYCLE_DISTANCE * size) / length_unit;
    parameters.normalized_max_linear_velocity = (max_speed / length_unit).min(Real::MAX);
}

/// A narrow phase with the default [`VpsDispatcher`] before parry's own: the first of the three settings
/// of [`set_up`]. Without it VPS shapes collide with nothing, see [`check`](crate::check).
pub fn narrow_phase() -> NarrowPhase {
    NarrowPhase::with_query_dispatcher(VpsDispatcher::default().chain(DefaultQueryDispatcher))
}
