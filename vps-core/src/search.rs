//! How a query goes through the tree.

use wide::f32x4;

use crate::dispatch::dispatch;
use crate::lanes::Vectors;
use crate::query::Query;
use crate::tree::{Cluster, MAX_LEVELS};
use crate::work::CountWork;
use crate::{Contact, Discs, DistanceField, LANES, PointSphereTree, Points};

/// What a search looks for: contacts with a score of at least [`least`](Self::least).
pub(crate) trait Goal {
    /// Whether of several clusters the one with the highest score is looked at first; otherwise
    /// the first one is, and contacts come in the order of the points.
    const BEST_FIRST: bool;

    /// Whether it is all contacts that matter, and no bound is asked for. What is likely to be in the
    /// field as a whole is then looked at without bounding its parts first.
    const ALL: bool = false;

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

/// The children of one cluster that are still to be looked at.
#[derive(Clone, Copy)]
struct Frame {
    /// Bounds of some of them, minus infinity for those that are done with.
    bounds: f32x4,
    /// The first one with a bound.
    first: u32,
    /// Those without.
    next: u32,
    end: u32,
}

impl Frame {
    const EMPTY: Self = Self {
        bounds: f32x4::splat(f32::NEG_INFINITY),
        first: 0,
        next: 0,
        end: 0,
    };

    /// Children in a range of the level that starts at a position among all clusters.
    #[inline(always)]
    fn of(start: u32, range: (u32, u32)) -> Self {
        Self {
            next: start + range.0,
            end: start + range.1,
            ..Self::EMPTY
        }
    }

    /// Gives the next children the bound of their parent.
    #[inline(always)]
    fn inherit(&mut self, bound: f32) {
        let count = (self.end - self.next).min(LANES as u32);
        self.first = self.next;
        self.next += count;
        self.bounds = below(count).select(f32x4::splat(bound), Self::EMPTY.bounds);
    }

    /// The next child whose bound is not below `least`, and its bound.
    #[inline(always)]
    fn take(&mut self, best_first: bool, least: f32) -> Option<(u32, f32)> {
        // Above minus infinity, whatever is asked for.
        let least = f32x4::splat(least).fast_max(f32x4::splat(f32::MIN));
        let mut lanes = self.bounds.simd_ge(least);
        if best_first {
            let [a, b, c, d] = self.bounds.to_array();
            let max = |a: f32, b: f32| if a > b { a } else { b };
            let most = f32x4::splat(max(max(a, b), max(c, d)));
            lanes &= self.bounds.simd_eq(most);
        }
        let lanes = lanes.to_bitmask();
        if lanes == 0 {
            return None;
        }
        let lane = lanes.trailing_zeros();
        let bound = self.bounds.to_array()[lane as usize % LANES];
        // All at once, so that it need not be waited for when it is read again.
        let taken = NUMBERS.simd_eq(f32x4::splat(lane as f32));
        self.bounds = taken.select(f32x4::splat(f32::NEG_INFINITY), self.bounds);
        Some((self.first + lane, bound))
    }
}

/// Of the lanes.
const NUMBERS: f32x4 = f32x4::new([0.0, 1.0, 2.0, 3.0]);

impl<F: DistanceField + ?Sized, W: CountWork> Query<'_, F, W> {
    /// Branch and bound below the clusters `range` of a level. Nothing is left out that has the
    /// least score, so what is best is found whatever the order.
    #[inline(always)]
    pub(crate) fn search<G: Goal>(&self, level: u32, range: (u32, u32), goal: &mut G) {
        let leaves = self.tree.level(self.tree.level_count());
        self.descend(
            (level, range),
            self.tree.level_count(),
            goal,
            #[inline(always)]
            |leaf, _, goal| {
                let leaf = &leaves[leaf as usize];
                self.offer_points((leaf.first, leaf.first + leaf.count), goal)
            },
        );
    }

    /// Goes from the clusters of one level down to level `last`, depth first, and calls `reached`
    /// there with the clusters that may matter and their bounds, until it returns false.
    #[inline(always)]
    pub(crate) fn descend<G: Goal>(
        &self,
        (level, range): (u32, (u32, u32)),
        last: u32,
        goal: &mut G,
        mut reached: impl FnMut(u32, f32, &mut G) -> bool,
    ) {
        if !self.is_posed {
            return;
        }
        let (clusters, starts) = (self.tree.clusters(), self.tree.level_starts());
        let (top, bottom) = (level as usize, last as usize);
        let mut root = Frame::of(starts[top - 1], range);
        self.fill(clusters, &mut root, goal);
        // The first look costs little: most bodies of a scene are apart.
        if root.next == root.end && !root.bounds.simd_ge(f32x4::splat(goal.least())).any() {
            return;
        }
        let mut frames = [Frame::EMPTY; MAX_LEVELS + 1];
        let mut at = top;
        frames[at] = root;
        loop {
            let frame = &mut frames[at];
            let Some((child, bound)) = frame.take(G::BEST_FIRST, goal.least()) else {
                if frame.next < frame.end {
                    self.fill(clusters, frame, goal);
                } else if at == top {
                    return;
                } else {
                    at -= 1;
                }
                continue;
            };
            if at == bottom {
                if !reached(child - starts[bottom - 1], bound, goal) {
                    return;
                }
            } else {
                let cluster = &clusters[child as usize];
                let range = (cluster.first, cluster.first + cluster.count);
                let mut frame = Frame::of(starts[at], range);
                at += 1;
                if G::ALL && bound - goal.least() > 2.0 * cluster.radius {
                    frame.inherit(bound);
                } else {
                    self.fill(clusters, &mut frame, goal);
                }
                frames[at] = frame;
            }
        }
    }

    /// Bounds the next children of a frame.
    #[inline(always)]
    fn fill<G: Goal>(&self, clusters: &[Cluster], frame: &mut Frame, goal: &G) {
        let count = (frame.end - frame.next).min(LANES as u32);
        self.work.spheres(count);
        frame.first = frame.next;
        frame.next += count;
        let (discs, penetrations) = self.bounds_of(&clusters[frame.first as usize..]);
        let bounds = goal.bounds(&discs, f32x4::new(penetrations));
        // What is no number is below everything, and so are the lanes that are not in use.
        let counts = below(count) & bounds.simd_eq(bounds);
        frame.bounds = counts.select(bounds, f32x4::splat(f32::NEG_INFINITY));
    }

    /// Whether there may be a contact, by a look at the cluster of all points.
    pub(crate) fn may_touch(&self) -> bool {
        let top = &self.tree.clusters()[..1];
        self.is_posed
            && dispatch(
                #[inline(always)]
                || self.bounds_of(top).1[0] >= -self.margin,
            )
    }

    /// The discs of the first [`LANES`] clusters in the shell frame, and bounds of the penetration in
    /// them. Should there be fewer, the last is repeated.
    #[inline(always)]
    pub(crate) fn bounds_of(&self, clusters: &[Cluster]) -> (Discs, [f32; LANES]) {
        let (a, b, c, d) = match clusters {
            [a, b, c, d, ..] => (a.disc(), b.disc(), c.disc(), d.disc()),
            _ => {
                let disc = |lane: usize| clusters[lane.min(clusters.len() - 1)].disc();
                (disc(0), disc(1), disc(2), disc(3))
            }
        };
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
            let penetrations = f32x4::new(self.field.penetrations(
                &self.to_field(positions.into()).into(),
                &Vectors::from(inward).rotated(&self.rotation).into(),
            ));
            let counts =
                below(end - next) & penetrations.simd_ge(f32x4::splat(goal.least_penetration()));
            let found = Found {
                tree: self.tree,
                first: next,
                counts,
                positions: positions.into(),
                inward: inward.into(),
                penetrations,
            };
            if counts.any() && !goal.offer(&found) {
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
}

impl Found<'_> {
    /// The contacts one by one, in order.
    #[inline(always)]
    pub(crate) fn each(&self) -> impl Iterator<Item = Contact> {
        let mut lanes = self.counts.to_bitmask();
        core::iter::from_fn(move || {
            if lanes == 0 {
                return None;
            }
            let lane = lanes.trailing_zeros();
            lanes &= lanes - 1;
            let point = self.first + lane;
            Some(Contact {
                point,
                position: self.tree.point(point as usize),
                normal: self.tree.normal(point as usize),
                penetration: self.penetrations.to_array()[lane as usize % LANES],
            })
        })
    }
}

/// The first lanes, so many as are in use.
#[inline(always)]
fn below(count: u32) -> f32x4 {
    NUMBERS.simd_lt(f32x4::splat(count as f32))
}
