//! A dispatcher that times another one.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use rapier3d::geometry::{ContactData, ContactManifold, ContactManifoldData};
use rapier3d::math::{Pose, Real, Vector};
use rapier3d::parry::query::details::{NormalConstraints, ShapeCastOptions};
use rapier3d::parry::query::{
    ClosestPoints, Contact, ContactManifoldsWorkspace, NonlinearRigidMotion,
    PersistentQueryDispatcher, QueryDispatcher, ShapeCastHit, ShapeDistance, ShapeIntersection,
    Unsupported,
};
use rapier3d::parry::shape::Shape;
use vps_compare::Dispatcher;

/// Counts queries and their time since the last reading.
#[derive(Debug, Default)]
pub(crate) struct Stopwatch {
    ns: AtomicU64,
    queries: AtomicU64,
    unsupported: AtomicU64,
}

/// A reading of the stopwatch.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct QueryTimes {
    pub(crate) ns: u64,
    pub(crate) count: u64,
    /// Queries that are not supported, which the engine would ignore.
    pub(crate) unsupported: u64,
}

impl Stopwatch {
    /// Reads and resets the stopwatch.
    pub(crate) fn take(&self) -> QueryTimes {
        let take = |n: &AtomicU64| n.swap(0, Ordering::Relaxed);
        QueryTimes {
            ns: take(&self.ns),
            count: take(&self.queries),
            unsupported: take(&self.unsupported),
        }
    }

    /// The overhead of timing in nanoseconds: the median of many empty measurements.
    pub(crate) fn overhead_ns() -> u64 {
        let mut samples: Vec<_> = (0..10_001)
            .map(|_| {
                let start = Instant::now();
                std::hint::black_box(());
                start.elapsed().as_nanos() as u64
            })
            .collect();
        samples.sort_unstable();
        samples[samples.len() / 2]
    }
}

/// Forwards to a dispatcher and times its contact queries.
pub(crate) struct TimedDispatcher {
    inner: Arc<Dispatcher>,
    stopwatch: Arc<Stopwatch>,
}

impl TimedDispatcher {
    pub(crate) fn new(inner: Arc<Dispatcher>, stopwatch: Arc<Stopwatch>) -> Self {
        Self { inner, stopwatch }
    }
}

impl PersistentQueryDispatcher<ContactManifoldData, ContactData> for TimedDispatcher {
    fn contact_manifolds(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
        prediction: Real,
        manifolds: &mut Vec<ContactManifold>,
        workspace: &mut Option<ContactManifoldsWorkspace>,
    ) -> Result<(), Unsupported> {
        let start = Instant::now();
        let result = self
            .inner
            .contact_manifolds(pos12, g1, g2, prediction, manifolds, workspace);
        let ns = start.elapsed().as_nanos() as u64;
        self.stopwatch.ns.fetch_add(ns, Ordering::Relaxed);
        self.stopwatch.queries.fetch_add(1, Ordering::Relaxed);
        if result.is_err() {
            self.stopwatch.unsupported.fetch_add(1, Ordering::Relaxed);
        }
        result
    }

    fn contact_manifold_convex_convex(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
        constraints1: Option<&dyn NormalConstraints>,
        constraints2: Option<&dyn NormalConstraints>,
        prediction: Real,
        manifold: &mut ContactManifold,
    ) -> Result<(), Unsupported> {
        self.inner.contact_manifold_convex_convex(
            pos12,
            g1,
            g2,
            constraints1,
            constraints2,
            prediction,
            manifold,
        )
    }
}

impl QueryDispatcher for TimedDispatcher {
    fn intersection_test(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
    ) -> Result<ShapeIntersection, Unsupported> {
        self.inner.intersection_test(pos12, g1, g2)
    }

    fn distance(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
    ) -> Result<ShapeDistance, Unsupported> {
        self.inner.distance(pos12, g1, g2)
    }

    fn contact(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
        prediction: Real,
    ) -> Result<Option<Contact>, Unsupported> {
        self.inner.contact(pos12, g1, g2, prediction)
    }

    fn closest_points(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
        max_dist: Real,
    ) -> Result<ClosestPoints, Unsupported> {
        self.inner.closest_points(pos12, g1, g2, max_dist)
    }

    fn cast_shapes(
        &self,
        pos12: &Pose,
        local_vel12: Vector,
        g1: &dyn Shape,
        g2: &dyn Shape,
        options: ShapeCastOptions,
    ) -> Result<Option<ShapeCastHit>, Unsupported> {
        self.inner.cast_shapes(pos12, local_vel12, g1, g2, options)
    }

    fn cast_shapes_nonlinear(
        &self,
        motion1: &NonlinearRigidMotion,
        g1: &dyn Shape,
        motion2: &NonlinearRigidMotion,
        g2: &dyn Shape,
        start_time: Real,
        end_time: Real,
        stop_at_penetration: bool,
    ) -> Result<Option<ShapeCastHit>, Unsupported> {
        self.inner.cast_shapes_nonlinear(
            motion1,
            g1,
            motion2,
            g2,
            start_time,
            end_time,
            stop_at_penetration,
        )
    }
}
