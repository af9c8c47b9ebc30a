//! A query that may be stopped at any time.

use glamx::Vec3;

use crate::field::DistanceField;
use crate::force::wrench::{Weight, Wrench, WrenchSum};
use crate::query::collectors::{Collector, DeepestContact, TestedPoints};
use crate::query::contact::Contact;
use crate::query::observer::Observer;
use crate::query::posed::Query;
use crate::query::search::ROOT;

/// The state of a time-critical query when it ends.
///
/// ```
/// use vps_core::{HalfSpace, PointSphereTree, Pose3, Query, Vec3};
///
/// // The ends of a peg that stands on the ground, one of them 10 mm too deep.
/// let (low, high) = (Vec3::new(0.0, -0.01, 0.0), Vec3::new(0.0, 0.2, 0.0));
/// let tree = PointSphereTree::flat(&[low, high], &[Vec3::Y, Vec3::NEG_Y], 1e-4)?;
/// let ground = HalfSpace::new(Vec3::Y);
/// let query = Query::new(&tree, &ground, Pose3::IDENTITY);
/// let estimate = query.time_critical(Vec3::ZERO, |tested| tested < 100);
/// assert!(estimate.is_complete);
/// assert_eq!(estimate.deepest, query.deepest());
/// // Stopped before the first point.
/// assert_eq!(query.time_critical(Vec3::ZERO, |_| false).level, 0);
/// # Ok::<(), vps_core::TreeError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The deepest of the tested points.
    pub deepest: Option<Contact>,
    /// Upper bound on the penetration of any contact, in metres. Once the query is complete it is that
    /// of the deepest contact, or −prediction if there is none.
    pub penetration_bound: f32,
    /// Penalty force and torque with [`Weight::Area`], estimated from the last complete level: all
    /// of a cluster is taken to be as deep as its parent point.
    pub wrench: Wrench,
    /// The last complete level, 0 for none.
    pub level: u32,
    /// Whether all contacts were found, so that the result is exact.
    pub is_complete: bool,
}

impl<F: DistanceField + ?Sized, O: Observer> Query<'_, F, O> {
    /// Time-critical query, from coarse to fine: the parent points of one level after the other
    /// (section 2.1.2), and finally all points. The paper's future work.
    ///
    /// `keep_going` is called before each point (in the last pass, before the points of each leaf)
    /// with the number of points tested so far, and ends the query by `false`: `|tested| tested <
    /// 500`, or `|_| clock() < deadline`. The torque is about `center`, in the shell frame. With
    /// more time the deepest contact does not get shallower and the bound does not rise.
    ///
    /// Needs no memory: each level is reached from the root again, which tests a few times as many
    /// spheres as [`for_each_contact`](Self::for_each_contact).
    pub fn time_critical(&self, center: Vec3, mut keep_going: impl FnMut(u64) -> bool) -> Estimate {
        let mut estimate = Estimate {
            deepest: None,
            penetration_bound: f32::INFINITY,
            wrench: Wrench::default(),
            level: 0,
            is_complete: false,
        };
        let mut tested = 0;
        let mut all = WrenchAndDeepest {
            sum: WrenchSum::new(self.tree, center, Weight::Area, -self.prediction),
            deepest: DeepestContact::new(self.prediction),
        };
        let clusters = self.tree.clusters();
        for level in 1..=self.tree.level_count() {
            let mut level_estimate = LevelEstimate::default();
            let mut bound = -self.prediction;
            let mut stopped = false;
            let mut test = |cluster: u32, cluster_bound: f32, _: &mut _| {
                if !keep_going(tested) {
                    stopped = true;
                    return false;
                }
                tested += 1;
                bound = bound.max(cluster_bound);
                let cluster = &clusters[cluster as usize];
                level_estimate.reached = true;
                if let Some(contact) = self.test_point(cluster.parent_point()) {
                    level_estimate.add(&contact, cluster.area(), center, &mut estimate.deepest);
                }
                true
            };
            self.multiversion(
                #[inline(always)]
                || self.descend(ROOT, level, &mut all, &mut test),
            );
            if stopped {
                return estimate;
            }
            estimate.penetration_bound = estimate.penetration_bound.min(bound);
            estimate.wrench = level_estimate.wrench;
            estimate.level = level;
            if !level_estimate.reached {
                estimate.is_complete = true;
                return estimate;
            }
        }
        let leaf_level = self.tree.level_count();
        all.deepest.found = estimate.deepest;
        let mut stopped = false;
        let mut test = |leaf: u32, _: f32, all: &mut WrenchAndDeepest<'_>| {
            if !keep_going(tested) {
                stopped = true;
                return false;
            }
            let points = clusters[leaf as usize].children();
            tested += u64::from(points.end - points.start);
            self.test_points((points.start, points.end), all)
        };
        self.multiversion(
            #[inline(always)]
            || self.descend(ROOT, leaf_level, &mut all, &mut test),
        );
        estimate.deepest = all.deepest.found;
        if !stopped {
            let deepest = estimate.deepest.map_or(-self.prediction, |d| d.penetration);
            estimate.penetration_bound = deepest;
            estimate.wrench = all.sum.wrench();
            estimate.is_complete = true;
        }
        estimate
    }
}

/// Collects force, torque and the deepest contact of all points.
struct WrenchAndDeepest<'q> {
    sum: WrenchSum<'q>,
    deepest: DeepestContact,
}

impl Collector for WrenchAndDeepest<'_> {
    const BEST_FIRST: bool = false;

    #[inline(always)]
    fn penetration_threshold(&self) -> f32 {
        self.sum.penetration_threshold()
    }

    #[inline(always)]
    fn add(&mut self, found: &TestedPoints<'_>) -> bool {
        self.deepest.add(found) && self.sum.add(found)
    }
}

/// The estimate from the parent points of one level.
#[derive(Default)]
struct LevelEstimate {
    wrench: Wrench,
    reached: bool,
}

impl LevelEstimate {
    fn add(&mut self, contact: &Contact, area: f32, center: Vec3, deepest: &mut Option<Contact>) {
        self.wrench.add(contact, area, center);
        if contact.is_deeper_than(deepest.as_ref()) {
            *deepest = Some(*contact);
        }
    }
}
