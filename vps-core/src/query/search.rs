//! How a query goes through the tree.

use glamx::Vec3;
use wide::f32x4;

use crate::field::{Discs, DistanceField};
use crate::query::contact::Contact;
use crate::query::posed::Query;
use crate::query::work::CountWork;
use crate::shell::{Cluster, MAX_LEVELS, PointSphereTree};
use crate::simd::multiversion::dispatch;
use crate::simd::{LANES, Points, Vectors, first_lanes, lanes_in, padded};

/// The cluster of all points: its level, and its number.
pub(crate) const TOP: (u32, u32) = (1, 0);

/// What a search looks for: contacts with a score of at least [`least`](Self::least).
pub(crate) trait Goal {
    /// Whether of several clusters the one with the highest score is looked at first; otherwise
    /// the first one is, and contacts come in the order of the points.
    const BEST_FIRST: bool;

    /// Whether it is all contacts that matter, and no bound is asked for. What is likely to be in the
    /// field as a whole is then looked at without bounding its parts first.
    const ALL: bool = false;

    /// Whether [`offer`](Self::offer) needs the way out of the solid at each contact.
    const WAY_OUT: bool = false;

    /// The highest score any contact in a disc (in the shell frame) can have, given upper bounds
    /// of the penetrations.
    fn bounds(&self, discs: &Discs, penetrations: f32x4) -> f32x4 {
        let _ = discs;
        penetrations
    }

    /// The score from which on contacts matter; it may rise with what was offered. The penetration,
    /// unless [`bounds`](Self::bounds) says otherwise.
    fn least(&self) -> f32 {
        self.least_penetration()
    }

    /// The penetration from which on contacts matter.
    fn least_penetration(&self) -> f32;

    /// Takes contacts with at least that penetration. False ends the search.
    fn offer(&mut self, found: &Found<'_>) -> bool;
}

/// A cluster that is still to be looked at.
#[derive(Clone, Copy)]
struct Entry {
    /// No contact below it has a higher score.
    bound: f32,
    /// Which of all clusters.
    cluster: u32,
    level: u32,
    /// How many of its children are done with.
    done: u32,
}

/// The clusters that are still to be looked at, the next one on top. On each level there are
/// [`LANES`] at most: those bounded together, of which the one in work may come back for more of its
/// children.
struct Stack {
    entries: [Entry; LANES * MAX_LEVELS],
    len: usize,
}

impl Stack {
    const EMPTY: Self = Self {
        entries: [Entry {
            bound: 0.0,
            cluster: 0,
            level: 0,
            done: 0,
        }; LANES * MAX_LEVELS],
        len: 0,
    };

    #[inline(always)]
    fn push(&mut self, entry: Entry) {
        self.entries[self.len] = entry;
        self.len += 1;
    }

    #[inline(always)]
    fn pop(&mut self) -> Option<Entry> {
        self.len = self.len.checked_sub(1)?;
        Some(self.entries[self.len])
    }

    /// Pushes an entry, but below those from position `base` on that have no lower bound.
    #[inline(always)]
    fn insert(&mut self, base: usize, entry: Entry) {
        let mut at = self.len;
        while at > base && self.entries[at - 1].bound >= entry.bound {
            self.entries[at] = self.entries[at - 1];
            at -= 1;
        }
        self.entries[at] = entry;
        self.len += 1;
    }
}

impl<F: DistanceField + ?Sized, W: CountWork> Query<'_, F, W> {
    /// Searches the whole tree for a goal, and gives what became of it.
    #[inline(always)]
    pub(crate) fn find<G: Goal>(&self, mut goal: G) -> G {
        dispatch(
            #[inline(always)]
            || self.search(TOP, &mut goal),
        );
        goal
    }

    /// The same for goals that may be offered a point twice.
    #[inline(always)]
    pub(crate) fn find_from_hint<G: Goal>(&self, goal: &mut G) {
        dispatch(
            #[inline(always)]
            || {
                let goes_on = match self.hint {
                    Some(point) if self.is_posed => self.offer_points((point, point + 1), goal),
                    _ => true,
                };
                if goes_on {
                    self.search(TOP, goal);
                }
            },
        );
    }

    /// Branch and bound below a cluster, given its level and its number among all. Nothing is left
    /// out that has the least score, so what is best is found whatever the order.
    #[inline(always)]
    pub(crate) fn search<G: Goal>(&self, top: (u32, u32), goal: &mut G) {
        let clusters = self.tree.clusters();
        self.descend(
            top,
            self.tree.level_count(),
            goal,
            #[inline(always)]
            |leaf, _, goal| {
                let leaf = &clusters[leaf as usize];
                self.offer_points((leaf.first, leaf.first + leaf.count), goal)
            },
        );
    }

    /// Goes from a cluster down to level `last`, depth first, and calls `reached` there with the
    /// clusters that may matter (their numbers among all) and their bounds, until it returns false.
    #[inline(always)]
    pub(crate) fn descend<G: Goal>(
        &self,
        (level, cluster): (u32, u32),
        last: u32,
        goal: &mut G,
        mut reached: impl FnMut(u32, f32, &mut G) -> bool,
    ) {
        if !self.is_posed {
            return;
        }
        let (clusters, starts) = (self.tree.clusters(), self.tree.level_starts());
        let [bound, ..] = self
            .bounds(&clusters[cluster as usize..], 1, goal)
            .to_array();
        // The first look costs little: most bodies of a scene are apart.
        if bound.is_nan() || bound < goal.least() {
            return;
        }
        let mut stack = Stack::EMPTY;
        stack.push(Entry {
            bound,
            cluster,
            level,
            done: 0,
        });
        while let Some(entry) = stack.pop() {
            let least = goal.least();
            if entry.bound < least {
                continue;
            }
            if entry.level == last {
                if !reached(entry.cluster, entry.bound, goal) {
                    return;
                }
                continue;
            }
            let cluster = &clusters[entry.cluster as usize];
            let left = cluster.count - entry.done;
            let first = starts[entry.level as usize] + cluster.first + entry.done;
            if left > LANES as u32 {
                let done = entry.done + LANES as u32;
                stack.push(Entry { done, ..entry });
            }
            let bounds = if G::ALL && entry.bound - least > 2.0 * cluster.radius {
                f32x4::splat(entry.bound)
            } else {
                self.bounds(&clusters[first as usize..], left.min(LANES as u32), goal)
            };
            // What is no number is left out.
            let kept = first_lanes(left) & bounds.simd_ge(f32x4::splat(least));
            let base = stack.len;
            let child = |lane: usize| Entry {
                bound: bounds.to_array()[lane],
                cluster: first + lane as u32,
                level: entry.level + 1,
                done: 0,
            };
            if G::BEST_FIRST {
                lanes_in(kept).for_each(|lane| stack.insert(base, child(lane)));
            } else {
                // The first one on top.
                for lane in (0..LANES)
                    .rev()
                    .filter(|lane| kept.to_bitmask() >> lane & 1 == 1)
                {
                    stack.push(child(lane));
                }
            }
        }
    }

    /// Bounds of the scores in the first `count` clusters, [`LANES`] at most.
    #[inline(always)]
    fn bounds<G: Goal>(&self, clusters: &[Cluster], count: u32, goal: &G) -> f32x4 {
        self.work.spheres(count);
        let (discs, penetrations) = self.penetration_bounds(clusters);
        goal.bounds(&discs, f32x4::new(penetrations))
    }

    /// Whether there may be a contact, by a look at the cluster of all points.
    pub(crate) fn may_touch(&self) -> bool {
        self.work.spheres(1);
        let top = &self.tree.clusters()[..1];
        self.is_posed
            && dispatch(
                #[inline(always)]
                || self.penetration_bounds(top).1[0] >= -self.margin,
            )
    }

    /// The discs of the first [`LANES`] clusters in the shell frame, and bounds of the penetration in
    /// them. Should there be fewer, the last is repeated.
    #[inline(always)]
    fn penetration_bounds(&self, clusters: &[Cluster]) -> (Discs, [f32; LANES]) {
        let [a, b, c, d] = padded(clusters, |four| {
            [
                four[0].disc(),
                four[1].disc(),
                four[2].disc(),
                four[3].disc(),
            ]
        });
        let [x, y, z, radii] = f32x4::transpose([a.0, b.0, c.0, d.0]);
        let centers = Vectors { x, y, z };
        let [x, y, z, thickness] = f32x4::transpose([a.1, b.1, c.1, d.1]);
        let normals = Vectors { x, y, z };
        let discs = Discs {
            centers: centers.into(),
            radii: radii.to_array(),
            normals: normals.into(),
            lifts: [a.2[0], b.2[0], c.2[0], d.2[0]],
            bulges: [a.2[1], b.2[1], c.2[1], d.2[1]],
            thickness: thickness.to_array(),
        }
        .grown(self.ball_slack);
        let in_field = Discs {
            centers: self.to_field(centers).into(),
            normals: normals.rotated(&self.rotation).into(),
            ..discs
        };
        (discs, self.field.penetration_bounds(&in_field))
    }

    /// Tests points one after the other; the pose must be finite. False ends the search.
    #[inline(always)]
    pub(crate) fn offer_points<G: Goal>(&self, (first, end): (u32, u32), goal: &mut G) -> bool {
        let (points, normals) = (self.tree.points(), self.tree.normals());
        self.work.points(end - first);
        let mut next = first;
        while next < end {
            let positions = Points::read(points, next as usize);
            let inward = Points::read(normals, next as usize);
            let in_field = self.to_field(positions.into()).into();
            let inward_in_field = Vectors::from(inward).rotated(&self.rotation).into();
            let (penetrations, way_out) = if G::WAY_OUT {
                let (penetrations, gradients) = self
                    .field
                    .penetrations_and_gradients(&in_field, &inward_in_field);
                let gradients = Vectors::from(gradients);
                (
                    penetrations,
                    gradients.rotated(&self.rotation.transpose()).negated(),
                )
            } else {
                let penetrations = self.field.penetrations(&in_field, &inward_in_field);
                (penetrations, Vectors::splat(Vec3::ZERO))
            };
            let penetrations = f32x4::new(penetrations);
            let least = f32x4::splat(goal.least_penetration());
            let found = Found {
                tree: self.tree,
                first: next,
                counts: first_lanes(end - next) & penetrations.simd_ge(least),
                positions: positions.into(),
                inward: inward.into(),
                penetrations,
                way_out,
            };
            if found.counts.any() && !goal.offer(&found) {
                return false;
            }
            next += LANES as u32;
        }
        true
    }
}

/// Points that were tested together.
pub(crate) struct Found<'t> {
    tree: &'t PointSphereTree<'t>,
    /// The first one's number.
    pub(crate) first: u32,
    /// Which of them are contacts.
    pub(crate) counts: f32x4,
    /// In the shell frame, and so the normals.
    pub(crate) positions: Vectors,
    pub(crate) inward: Vectors,
    pub(crate) penetrations: f32x4,
    /// How much shallower a point is, per metre it is moved; zero unless the goal asks for it.
    pub(crate) way_out: Vectors,
}

impl Found<'_> {
    /// The contacts one by one, in order.
    #[inline(always)]
    pub(crate) fn each(&self) -> impl Iterator<Item = Contact> {
        self.each_in(self.counts)
    }

    /// Those of the given lanes.
    #[inline(always)]
    pub(crate) fn each_in(&self, lanes: f32x4) -> impl Iterator<Item = Contact> {
        lanes_in(lanes).map(
            #[inline(always)]
            |lane| self.contact(lane),
        )
    }

    #[inline(always)]
    pub(crate) fn contact(&self, lane: usize) -> Contact {
        let penetration = self.penetrations.to_array()[lane];
        Contact::of(self.tree, self.first + lane as u32, penetration)
    }
}
