//! Observers: what a query does, event by event.

use crate::query::contact::Contact;

/// Takes the events of a query that it observes: see
/// [`Query::observed_by`](crate::Query::observed_by).
///
/// A closure `Fn(Event)` is an observer; so is a reference to [`Work`](crate::Work), which counts. `()`
/// observes nothing and costs nothing: a query is compiled without its events then.
///
/// `E` is the type of the events, [`Event`] for a query.
///
/// ```
/// use std::cell::RefCell;
/// use vps_core::{Cuboid, Event, PointSphereTree, Pose3, Query, Vec3};
/// // A single point with its inward normal.
/// let tree = PointSphereTree::flat(&[Vec3::ZERO], &[Vec3::Y], 1e-4)?;
/// let ground = Cuboid::new(Vec3::new(1.0, 0.1, 1.0));
/// // 10 mm above the ground: why is there no contact?
/// let pose = Pose3::from_translation(Vec3::new(0.0, 0.11, 0.0));
/// let events = RefCell::new(Vec::new());
/// let query = Query::new(&tree, &ground, pose);
/// let manifold = query.observed_by(|event: Event| events.borrow_mut().push(event)).manifold::<4>();
/// assert!(manifold.contacts().is_empty());
/// // The cluster of all points was pruned: none of them is as deep as a contact must be.
/// let pruned = events.into_inner().into_iter().find_map(|event| match event {
///     Event::ClusterPruned { level, bound, threshold, .. } => Some((level, bound, threshold)),
///     _ => None,
/// });
/// let (level, bound, threshold) = pruned.unwrap();
/// assert!(level == 1 && bound < -0.009 && threshold == 0.0);
/// # Ok::<(), vps_core::TreeError>(())
/// ```
pub trait Observer<E = Event> {
    /// Whether there is anything to observe. Events are not even made if it is false.
    const IS_ACTIVE: bool = true;

    /// Takes an event, in the order in which they happen.
    fn observe(&self, event: E);
}

impl<E> Observer<E> for () {
    const IS_ACTIVE: bool = false;

    fn observe(&self, _event: E) {}
}

impl<E, T: Fn(E)> Observer<E> for T {
    fn observe(&self, event: E) {
        self(event);
    }
}

/// An event of a query. Clusters are named by their level, 1 being the top, and their index among
/// [all clusters](crate::PointSphereTree::clusters); points by their index in the shell.
///
/// A query does one or more searches, from [`SearchStarted`](Self::SearchStarted) to
/// [`SearchEnded`](Self::SearchEnded); that for segments does one for each segment within another one. In
/// a search each cluster is pruned or descended into at most once. Unless it ends early, as that of
/// [`Query::touches`](crate::Query::touches) does, each point below its top is either tested or below
/// exactly one pruned cluster.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event {
    /// A search begins below a cluster and goes down to a level. Within it all bounds and thresholds of
    /// clusters are scores.
    SearchStarted {
        /// The cluster at the top of the search.
        cluster: u32,
        /// Its level.
        level: u32,
        /// The level of the last clusters, whose points or parent points are tested.
        last_level: u32,
        /// What clusters are judged by.
        score: Score,
    },
    /// The search that started last ends.
    SearchEnded,
    /// The score of the points of a cluster was bounded. A cluster that lies in the field as a whole is
    /// not bounded when all contacts are collected; it has the bound of its parent.
    ClusterBounded {
        /// The cluster.
        cluster: u32,
        /// Its level.
        level: u32,
        /// Upper bound of the scores of its points.
        bound: f32,
    },
    /// None of the points of a cluster matters: its bound is below the threshold.
    ClusterPruned {
        /// The cluster.
        cluster: u32,
        /// Its level.
        level: u32,
        /// Upper bound of the scores of its points: its own, or that of its parent.
        bound: f32,
        /// The lowest score that matters, as the search went so far.
        threshold: f32,
    },
    /// The children or, on the last level, the points of a cluster are looked at.
    ClusterDescended {
        /// The cluster.
        cluster: u32,
        /// Its level.
        level: u32,
        /// Upper bound of the scores of its points: its own, or that of its parent.
        bound: f32,
        /// The lowest score that matters, as the search went so far.
        threshold: f32,
    },
    /// The penetration of a point was computed.
    PointTested {
        /// The point.
        point_index: u32,
        /// Its penetration in metres, positive inside.
        penetration: f32,
        /// The lowest penetration that matters in metres, as the search went so far.
        threshold: f32,
        /// Whether it is that deep, and so becomes a contact or a candidate for one.
        is_kept: bool,
    },
    /// The fate of a contact in contact reduction, after all searches of a
    /// [`ContactManifold`](crate::ContactManifold). Each contact within the prediction distance has one.
    /// To tell it, an observed query visits all contacts once more, without events.
    ContactReduced {
        /// The contact.
        contact: Contact,
        /// What becomes of it.
        fate: Fate,
    },
}

/// What a search judges clusters by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Score {
    /// Penetration, in metres.
    Penetration,
    /// What a point adds to the size of a manifold, by the weight of its depth: a length in metres for
    /// the second contact, twice an area in m² for later ones.
    Gain,
}

/// What becomes of a contact in contact reduction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fate {
    /// It is in the manifold, the deepest being number 0.
    Kept {
        /// Its index in the manifold.
        rank: u32,
    },
    /// It lies exactly where a contact of the manifold does.
    Merged {
        /// The index of that contact in the manifold.
        rank: u32,
    },
    /// It is not in the manifold.
    Dropped(DropReason),
}

/// Why contact reduction drops a contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DropReason {
    /// It has less than half of the weight of the deepest contact, being further outside of the solid,
    /// and the manifold needs none of those to reach four contacts.
    LowWeight,
    /// It adds no area: it lies within the polygon of the selected contacts.
    NoArea,
    /// It would add area, but the field is planar, where four contacts support a body.
    Planar,
    /// It would add area, less than those selected before it, but the manifold is full.
    Full,
}
