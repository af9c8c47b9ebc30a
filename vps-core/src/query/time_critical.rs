//! As much of the contact set as there is time for.

use glamx::Vec3;

use crate::field::DistanceField;
use crate::force::wrench::{Sum, Weight, Wrench};
use crate::query::collectors::Deepest;
use crate::query::contact::Contact;
use crate::query::posed::Query;
use crate::query::search::{Found, Goal, TOP};
use crate::query::work::CountWork;
use crate::simd::multiversion::dispatch;

/// What a query knows of the contact set when its time is over.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The deepest of the points that were tested.
    pub deepest: Option<Contact>,
    /// No contact has a larger penetration than this, in metres; equal to that of the deepest once
    /// all is known, and −margin if there is no contact.
    pub penetration_bound: f32,
    /// Penalty force and torque with [`Weight::Area`], from the last level that was finished: each
    /// cluster as if all of it were as deep as its parent point.
    pub wrench: Wrench,
    /// That level, 0 for none.
    pub level: u32,
    /// Whether all contacts were found: the result is that of the whole query.
    pub is_complete: bool,
}

impl<F: DistanceField + ?Sized, W: CountWork> Query<'_, F, W> {
    /// Finds out as much as there is time for, coarse first: the parent points of one level after
    /// the other (section 2.1.2), in the end all points. The paper's future work.
    ///
    /// `go_on` is asked before each point (at last, before those of each leaf), given how many were
    /// tested so far, and ends the query by `false`: `|tested| tested < 500`, or `|_| clock() < deadline`. The torque is about
    /// `center`, in the shell frame. With more time the deepest contact gets no less deep and the
    /// bound no higher.
    ///
    /// Needs no memory: each level is reached from the top again, which all in all looks at a few
    /// times as many spheres as [`for_each_contact`](Self::for_each_contact).
    pub fn time_critical(&self, center: Vec3, mut go_on: impl FnMut(u64) -> bool) -> Estimate {
        let mut estimate = Estimate {
            deepest: None,
            penetration_bound: f32::INFINITY,
            wrench: Wrench::default(),
            level: 0,
            is_complete: false,
        };
        let mut tested = 0;
        let mut all = Everything {
            sum: Sum::new(self.tree, center, Weight::Area, -self.margin),
            deepest: Deepest::new(self.margin),
        };
        let clusters = self.tree.clusters();
        for level in 1..=self.tree.level_count() {
            let mut pass = Pass::default();
            let mut bound = -self.margin;
            let mut stopped = false;
            let mut test = |cluster: u32, its_bound: f32, _: &mut _| {
                if !go_on(tested) {
                    stopped = true;
                    return false;
                }
                tested += 1;
                bound = bound.max(its_bound);
                let cluster = &clusters[cluster as usize];
                pass.reached = true;
                if let Some(contact) = self.test_point(cluster.parent_point) {
                    pass.add(&contact, cluster.area, center, &mut estimate.deepest);
                }
                true
            };
            dispatch(
                #[inline(always)]
                || self.descend(TOP, level, &mut all, &mut test),
            );
            if stopped {
                return estimate;
            }
            estimate.penetration_bound = estimate.penetration_bound.min(bound);
            estimate.wrench = pass.wrench;
            estimate.level = level;
            if !pass.reached {
                estimate.is_complete = true;
                return estimate;
            }
        }
        let leaf_level = self.tree.level_count();
        all.deepest.found = estimate.deepest;
        let mut stopped = false;
        let mut test = |leaf: u32, _: f32, all: &mut Everything<'_>| {
            if !go_on(tested) {
                stopped = true;
                return false;
            }
            let leaf = &clusters[leaf as usize];
            tested += u64::from(leaf.count);
            self.offer_points((leaf.first, leaf.first + leaf.count), all)
        };
        dispatch(
            #[inline(always)]
            || self.descend(TOP, leaf_level, &mut all, &mut test),
        );
        estimate.deepest = all.deepest.found;
        if !stopped {
            let deepest = estimate.deepest.map_or(-self.margin, |d| d.penetration);
            estimate.penetration_bound = deepest;
            estimate.wrench = all.sum.wrench();
            estimate.is_complete = true;
        }
        estimate
    }
}

/// What all points tell.
struct Everything<'q> {
    sum: Sum<'q>,
    deepest: Deepest,
}

impl Goal for Everything<'_> {
    const BEST_FIRST: bool = false;

    #[inline(always)]
    fn least_penetration(&self) -> f32 {
        self.sum.least_penetration()
    }

    #[inline(always)]
    fn offer(&mut self, found: &Found<'_>) -> bool {
        self.deepest.offer(found) && self.sum.offer(found)
    }
}

/// What one level tells.
#[derive(Default)]
struct Pass {
    wrench: Wrench,
    reached: bool,
}

impl Pass {
    fn add(&mut self, contact: &Contact, area: f32, center: Vec3, deepest: &mut Option<Contact>) {
        self.wrench.add(contact, area, center);
        if contact.is_deeper_than(deepest.as_ref()) {
            *deepest = Some(*contact);
        }
    }
}
