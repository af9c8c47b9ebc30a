//! Counters of the work of a query.

use core::cell::Cell;

use crate::query::observer::{Event, Observer};

/// Counters of the clusters and points that a query tested. A reference to it is an observer: see
/// [`Query::observed_by`](crate::Query::observed_by).
///
/// ```
/// use vps_core::{HalfSpace, PointSphereTree, Pose3, Query, Vec3, Work};
///
/// // The ends of a peg that stands on the ground, one of them 10 mm too deep.
/// let (low, high) = (Vec3::new(0.0, -0.01, 0.0), Vec3::new(0.0, 0.2, 0.0));
/// let tree = PointSphereTree::flat(&[low, high], &[Vec3::Y, Vec3::NEG_Y], 1e-4)?;
/// let ground = HalfSpace::new(Vec3::Y);
/// let work = Work::default();
/// let far = Pose3::from_translation(Vec3::Y);
/// Query::new(&tree, &ground, far).observed_by(&work).touches();
/// assert_eq!((work.spheres(), work.points()), (1, 0));
/// # Ok::<(), vps_core::TreeError>(())
/// ```
#[derive(Debug, Default)]
pub struct Work {
    spheres: Cell<u64>,
    points: Cell<u64>,
}

impl Work {
    /// Clusters whose penetration was bounded.
    pub fn spheres(&self) -> u64 {
        self.spheres.get()
    }

    /// Points whose penetration was computed.
    pub fn points(&self) -> u64 {
        self.points.get()
    }
}

impl Observer for &Work {
    fn observe(&self, event: Event) {
        let counter = match event {
            Event::ClusterBounded { .. } => &self.spheres,
            Event::PointTested { .. } => &self.points,
            _ => return,
        };
        counter.set(counter.get() + 1);
    }
}
