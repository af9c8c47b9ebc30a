//! Counters of the work of a query.

use core::cell::Cell;

/// Counters of the clusters and points that a query tested: see
/// [`Query::counting`](crate::Query::counting).
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
/// Query::new(&tree, &ground, far).counting(&work).touches();
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

/// A counter of the work of a query: a [`Work`], or `()`, which counts nothing and costs nothing.
///
/// ```
/// use vps_core::{
///     CountWork, DistanceField, HalfSpace, PointSphereTree, Pose3, Query, Vec3, Work,
/// };
///
/// // The ends of a peg that stands on the ground, one of them 10 mm too deep.
/// let (low, high) = (Vec3::new(0.0, -0.01, 0.0), Vec3::new(0.0, 0.2, 0.0));
/// let tree = PointSphereTree::flat(&[low, high], &[Vec3::Y, Vec3::NEG_Y], 1e-4)?;
/// let ground = HalfSpace::new(Vec3::Y);
/// fn depth(query: &Query<'_, impl DistanceField, impl CountWork>) -> Option<f32> {
///     query.deepest().map(|contact| contact.penetration)
/// }
///
/// let (query, work) = (Query::new(&tree, &ground, Pose3::IDENTITY), Work::default());
/// assert_eq!(depth(&query), depth(&query.counting(&work)));
/// # Ok::<(), vps_core::TreeError>(())
/// ```
pub trait CountWork {
    /// Adds `count` spheres.
    fn spheres(&self, _count: u32) {}
    /// Adds `count` points.
    fn points(&self, _count: u32) {}
}

impl CountWork for () {}

impl CountWork for &Work {
    fn spheres(&self, count: u32) {
        self.spheres.set(self.spheres.get() + u64::from(count));
    }

    fn points(&self, count: u32) {
        self.points.set(self.points.get() + u64::from(count));
    }
}
