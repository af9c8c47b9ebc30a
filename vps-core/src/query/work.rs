//! Counters of the work of a query.

use core::cell::Cell;

/// Counters of the clusters and points that a query tested: see
/// [`Query::counting`](crate::Query::counting).
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
