//! Branch and bound through the point-sphere tree, for any collector.

use glamx::Vec3;
use wide::f32x4;

use crate::field::{Discs, DistanceField};
use crate::query::collectors::{Collector, TestedPoints};
use crate::query::observer::{Event, Observer, Score};
use crate::query::posed::Query;
use crate::shell::{Cluster, MAX_LEVELS, PointSphereTree};
use crate::simd::{LANES, Points, Vectors, first_lanes, lanes_in, padded};

/// The cluster of all points: its level, and its index among all clusters.
pub(crate) const ROOT: (u32, u32) = (1, 0);

/// A cluster to visit.
#[derive(Clone, Copy)]
struct Entry {
    /// Upper bound on the scores of the contacts below it.
    bound: f32,
    /// Its index among all clusters.
    cluster: u32,
    level: u32,
    /// The number of its children that were visited.
    visited: u32,
}

/// The events of its visit.
impl Entry {
    /// Itself, or those of its children that were not visited, with its bound.
    fn unvisited(self, tree: &PointSphereTree<'_>) -> impl Iterator<Item = Self> {
        let (first, count, level) = if self.visited == 0 {
            (self.cluster, 1, self.level)
        } else {
            let cluster = &tree.clusters()[self.cluster as usize];
            let start = tree.level_starts()[self.level as usize];
            let first = start + cluster.0.first + self.visited;
            (first, cluster.0.count - self.visited, self.level + 1)
        };
        (first..first + count).map(move |cluster| Self {
            bound: self.bound,
            cluster,
            level,
            visited: 0,
        })
    }

    fn bounded(self) -> Event {
        Event::ClusterBounded {
            cluster: self.cluster,
            level: self.level,
            bound: self.bound,
        }
    }

    fn pruned(self, threshold: f32) -> Event {
        Event::ClusterPruned {
            cluster: self.cluster,
            level: self.level,
            bound: self.bound,
            threshold,
        }
    }

    fn descended(self, threshold: f32) -> Event {
        Event::ClusterDescended {
            cluster: self.cluster,
            level: self.level,
            bound: self.bound,
            threshold,
        }
    }
}

/// The clusters to visit, the next one on top. Of each level there are at most [`LANES`]: those that
/// were bounded together, of which the current one may be pushed again for its remaining children.
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
            visited: 0,
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

    /// Pushes an entry below those from position `base` on whose bound is at least its own.
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

impl<F: DistanceField + ?Sized, O: Observer> Query<'_, F, O> {
    /// Searches the whole tree, and returns the collector.
    #[inline(always)]
    pub(crate) fn collect<C: Collector>(&self, mut collector: C) -> C {
        self.multiversion(
            #[inline(always)]
            || self.search(ROOT, &mut collector),
        );
        collector
    }

    /// Searches the whole tree after testing the hint, for collectors that accept a point twice.
    #[inline(always)]
    pub(crate) fn collect_from_hint<C: Collector>(&self, collector: &mut C) {
        self.multiversion(
            #[inline(always)]
            || {
                let continues = match self.hint {
                    Some(point) if self.has_finite_pose => {
                        self.test_points((point, point + 1), collector)
                    }
                    _ => true,
                };
                if continues {
                    self.search(ROOT, collector);
                }
            },
        );
    }

    /// Branch and bound below a cluster, given its level and its index among all clusters. A contact
    /// with the threshold as its score is not pruned, so the result does not depend on the order.
    #[inline(always)]
    pub(crate) fn search<C: Collector>(&self, top: (u32, u32), collector: &mut C) {
        let clusters = self.tree.clusters();
        self.descend(
            top,
            self.tree.level_count(),
            collector,
            #[inline(always)]
            |leaf, _, collector| {
                let points = clusters[leaf as usize].children();
                self.test_points((points.start, points.end), collector)
            },
        );
    }

    /// Descends from a cluster to level `last`, depth first. Calls `visit` with the index and the
    /// bound of each cluster there that may matter, until it returns false.
    #[inline(always)]
    pub(crate) fn descend<C: Collector>(
        &self,
        (level, cluster): (u32, u32),
        last: u32,
        collector: &mut C,
        visit: impl FnMut(u32, f32, &mut C) -> bool,
    ) {
        if !self.has_finite_pose {
            return;
        }
        self.observe(|observer| {
            observer.observe(Event::SearchStarted {
                cluster,
                level,
                last_level: last,
                score: C::SCORE,
            });
        });
        self.visit_clusters((level, cluster), last, collector, visit);
        self.observe(|observer| observer.observe(Event::SearchEnded));
    }

    /// [`descend`](Self::descend) in a finite pose.
    #[inline(always)]
    fn visit_clusters<C: Collector>(
        &self,
        (level, cluster): (u32, u32),
        last: u32,
        collector: &mut C,
        mut visit: impl FnMut(u32, f32, &mut C) -> bool,
    ) {
        let (clusters, starts) = (self.tree.clusters(), self.tree.level_starts());
        let [bound, ..] = self
            .score_bounds(&clusters[cluster as usize..], collector)
            .to_array();
        let top = Entry {
            bound,
            cluster,
            level,
            visited: 0,
        };
        self.observe(|observer| observer.observe(top.bounded()));
        // Before the stack is set up: most bodies of a scene are apart.
        let threshold = collector.threshold();
        if bound.is_nan() || bound < threshold {
            self.observe(|observer| observer.observe(top.pruned(threshold)));
            return;
        }
        let mut stack = Stack::EMPTY;
        stack.push(top);
        while let Some(entry) = stack.pop() {
            let threshold = collector.threshold();
            if entry.bound < threshold {
                self.observe(|observer| {
                    let unvisited = entry.unvisited(self.tree);
                    unvisited.for_each(|entry| observer.observe(entry.pruned(threshold)));
                });
                continue;
            }
            self.observe(|observer| {
                if entry.visited == 0 {
                    observer.observe(entry.descended(threshold));
                }
            });
            if entry.level == last {
                if !visit(entry.cluster, entry.bound, collector) {
                    return;
                }
                continue;
            }
            let Cluster(cluster) = &clusters[entry.cluster as usize];
            let remaining = cluster.count - entry.visited;
            let first = starts[entry.level as usize] + cluster.first + entry.visited;
            if remaining > LANES as u32 {
                let visited = entry.visited + LANES as u32;
                stack.push(Entry { visited, ..entry });
            }
            let is_within = C::COLLECTS_ALL && entry.bound - threshold > 2.0 * cluster.radius;
            let bounds = if is_within {
                f32x4::splat(entry.bound)
            } else {
                self.score_bounds(&clusters[first as usize..], collector)
            };
            // The comparison prunes NaN as well.
            let kept = first_lanes(remaining) & bounds.simd_ge(f32x4::splat(threshold));
            let base = stack.len;
            let child = |lane: usize| Entry {
                bound: bounds.to_array()[lane],
                cluster: first + lane as u32,
                level: entry.level + 1,
                visited: 0,
            };
            self.observe(|observer| {
                let kept = kept.to_bitmask();
                for lane in 0..LANES.min(remaining as usize) {
                    if !is_within {
                        observer.observe(child(lane).bounded());
                    }
                    if kept >> lane & 1 == 0 {
                        observer.observe(child(lane).pruned(threshold));
                    }
                }
            });
            if C::BEST_FIRST {
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

    /// Upper bounds on the scores in the first [`LANES`] clusters. If there are fewer, the last one is
    /// repeated.
    #[inline(always)]
    fn score_bounds<C: Collector>(&self, clusters: &[Cluster], collector: &C) -> f32x4 {
        let (discs, penetrations) = self.penetration_bounds(clusters);
        collector.score_bounds(&discs, f32x4::new(penetrations))
    }

    /// Whether there may be a contact, by the bound of the cluster of all points.
    pub(crate) fn may_touch(&self) -> bool {
        if !self.has_finite_pose {
            return false;
        }
        let clusters = &self.tree.clusters()[..1];
        let bound = self.multiversion(
            #[inline(always)]
            || self.penetration_bounds(clusters).1[0],
        );
        let (level, cluster) = ROOT;
        let (threshold, visited) = (-self.prediction, 0);
        let top = Entry {
            bound,
            cluster,
            level,
            visited,
        };
        let may_touch = bound >= threshold;
        self.observe(|observer| {
            observer.observe(Event::SearchStarted {
                cluster,
                level,
                last_level: level,
                score: Score::Penetration,
            });
            observer.observe(top.bounded());
            observer.observe(if may_touch {
                top.descended(threshold)
            } else {
                top.pruned(threshold)
            });
            observer.observe(Event::SearchEnded);
        });
        may_touch
    }

    /// The discs of the first [`LANES`] clusters in the shell frame, and upper bounds on the
    /// penetration in them. If there are fewer, the last one is repeated.
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
        let [x, y, z, half_thicknesses] = f32x4::transpose([a.1, b.1, c.1, d.1]);
        let normals = Vectors { x, y, z };
        let discs = Discs {
            centers: centers.into(),
            radii: radii.to_array(),
            normals: normals.into(),
            apices: [a.2[0], b.2[0], c.2[0], d.2[0]],
            half_curvatures: [a.2[1], b.2[1], c.2[1], d.2[1]],
            half_thicknesses: half_thicknesses.to_array(),
        }
        .grown(self.rounding_slack);
        let in_field = Discs {
            centers: self.to_field(centers).into(),
            normals: normals.rotated(&self.rotation).into(),
            ..discs
        };
        (discs, self.field.penetration_bounds(&in_field))
    }

    /// Tests a range of points and adds the contacts to the collector. The pose must be finite. False
    /// ends the search.
    #[inline(always)]
    pub(crate) fn test_points<C: Collector>(
        &self,
        (first, end): (u32, u32),
        collector: &mut C,
    ) -> bool {
        let (points, normals) = (self.tree.points(), self.tree.normals());
        let mut next = first;
        while next < end {
            let positions = Points::read(points, next as usize);
            let inward = Points::read(normals, next as usize);
            let in_field = self.to_field(positions.into()).into();
            let inward_in_field = Vectors::from(inward).rotated(&self.rotation).into();
            let (penetrations, outward) = if C::NEEDS_GRADIENT {
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
            let threshold = f32x4::splat(collector.penetration_threshold());
            let found = TestedPoints {
                tree: self.tree,
                first: next,
                contact_mask: first_lanes(end - next) & penetrations.simd_ge(threshold),
                positions: positions.into(),
                inward: inward.into(),
                penetrations,
                outward,
            };
            self.observe(|observer| found.observe(end, threshold.to_array()[0], observer));
            if found.contact_mask.any() && !collector.add(&found) {
                return false;
            }
            next += LANES as u32;
        }
        true
    }
}
