//! A binary tree of bounding boxes of triangles: pairs whose boxes touch (broad phase).

use std::ops::Range;

use glamx::DVec3;
use rayon::prelude::*;
use vps_core::Vec3;

use crate::mesh::Mesh;

/// A complete binary tree over triangles. Each node is split at the median of its longest side.
pub(crate) struct BoxTree {
    /// Level by level; the children of node n are 2 n + 1 and 2 n + 2.
    nodes: Vec<Box32>,
    /// Triangles in the order of the leaves.
    items: Vec<BoundedTriangle>,
    levels: u32,
}

/// An axis-aligned box in 32 bits, rounded outwards.
#[derive(Clone, Copy)]
struct Box32 {
    low: Vec3,
    high: Vec3,
}

/// A triangle and its box.
type BoundedTriangle = (Box32, u32);

/// Approximate number of triangles of a leaf.
const LEAF: usize = 8;

impl BoxTree {
    /// Boxes are wider than the triangles by `margin` metres on each side.
    pub(crate) fn new(mesh: &Mesh, margin: f64) -> Self {
        let around = |t: usize| {
            let [a, b, c] = mesh.corners(t);
            Box32::around(a.min(b).min(c) - margin, a.max(b).max(c) + margin)
        };
        let count = mesh.triangles().len();
        let mut items: Vec<_> = (0..count).map(|t| (around(t), t as u32)).collect();
        let levels = (count / LEAF).max(1).ilog2();
        sort(&mut items, 0..1 << levels, count, levels);
        let mut tree = Self {
            nodes: vec![Box32::EMPTY; (2 << levels) - 1],
            items,
            levels,
        };
        let first_leaf = (1 << levels) - 1;
        for leaf in 0..1 << levels {
            let items = tree.leaf(leaf).iter();
            tree.nodes[first_leaf + leaf] = items.fold(Box32::EMPTY, |all, item| all.with(&item.0));
        }
        for n in (0..first_leaf).rev() {
            tree.nodes[n] = tree.nodes[2 * n + 1].with(&tree.nodes[2 * n + 2]);
        }
        tree
    }

    /// Calls `visit` with each pair of triangles whose boxes touch, until it returns false.
    pub(crate) fn for_each_pair(&self, visit: impl Fn(u32, u32) -> bool + Sync) {
        let first_leaf = (1 << self.levels) - 1;
        let all = (0..1_usize << self.levels).into_par_iter();
        // Each leaf against itself and all later leaves.
        let _stopped = all.try_for_each(|leaf| {
            let around = self.nodes[first_leaf + leaf];
            let mut stack = vec![(0_usize, 0_u32)];
            while let Some((node, level)) = stack.pop() {
                let below = self.levels - level;
                // The last leaf below the node.
                let last = ((node + 2) << below) - 2 - first_leaf;
                if last < leaf || !self.nodes[node].touches(&around) {
                    continue;
                }
                if below > 0 {
                    stack.extend([(2 * node + 2, level + 1), (2 * node + 1, level + 1)]);
                    continue;
                }
                for (i, (a, first)) in self.leaf(leaf).iter().enumerate() {
                    let others = if last == leaf {
                        &self.leaf(leaf)[i + 1..]
                    } else {
                        self.leaf(last)
                    };
                    for (b, second) in others {
                        if a.touches(b) && !visit(*first, *second) {
                            return None;
                        }
                    }
                }
            }
            Some(())
        });
    }

    /// Calls `visit` with each triangle whose box holds a point.
    pub(crate) fn for_each_at(&self, point: DVec3, mut visit: impl FnMut(u32)) {
        let first_leaf = (1 << self.levels) - 1;
        let around = Box32::around(point, point);
        let mut stack = vec![0_usize];
        while let Some(node) = stack.pop() {
            if !self.nodes[node].touches(&around) {
                continue;
            }
            if node < first_leaf {
                stack.extend([2 * node + 2, 2 * node + 1]);
                continue;
            }
            let items = self.leaf(node - first_leaf).iter();
            items
                .filter(|i| i.0.touches(&around))
                .for_each(|i| visit(i.1));
        }
    }

    fn leaf(&self, leaf: usize) -> &[BoundedTriangle] {
        let leaf_start = |leaf| leaf_start(leaf, self.items.len(), self.levels);
        &self.items[leaf_start(leaf)..leaf_start(leaf + 1)]
    }
}

/// Index of the first item of a leaf.
fn leaf_start(leaf: usize, count: usize, levels: u32) -> usize {
    (leaf * count) >> levels
}

/// Sorts the items of the given leaves by median splits. `count` is the number of items of all leaves.
fn sort(items: &mut [BoundedTriangle], leaves: Range<usize>, count: usize, levels: u32) {
    if leaves.len() < 2 {
        return;
    }
    let middle = |item: &BoundedTriangle| item.0.low + item.0.high;
    let empty = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    let (low, high) = items.iter().fold(empty, |(low, high), item| {
        (low.min(middle(item)), high.max(middle(item)))
    });
    let axis = (high - low).max_position();
    let half = leaves.start.midpoint(leaves.end);
    let first_half = leaf_start(half, count, levels) - leaf_start(leaves.start, count, levels);
    if first_half < items.len() {
        items.select_nth_unstable_by(first_half, |a, b| {
            let by_middle = middle(a)[axis].total_cmp(&middle(b)[axis]);
            by_middle.then(a.1.cmp(&b.1))
        });
    }
    let (left, right) = items.split_at_mut(first_half);
    rayon::join(
        || sort(left, leaves.start..half, count, levels),
        || sort(right, half..leaves.end, count, levels),
    );
}

impl Box32 {
    /// The empty box.
    const EMPTY: Self = Self {
        low: Vec3::INFINITY,
        high: Vec3::NEG_INFINITY,
    };

    /// The smallest 32-bit box around 64-bit corners.
    fn around(low: DVec3, high: DVec3) -> Self {
        let down = |c: f64| {
            let rounded = c as f32;
            if f64::from(rounded) > c {
                rounded.next_down()
            } else {
                rounded
            }
        };
        Self {
            low: Vec3::from_array(low.to_array().map(down)),
            high: -Vec3::from_array((-high).to_array().map(down)),
        }
    }

    fn with(&self, other: &Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
        }
    }

    fn touches(&self, other: &Self) -> bool {
        (self.low.cmple(other.high) & other.low.cmple(self.high)).all()
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Mutex;

    use super::*;

    #[test]
    fn each_pair_of_boxes_that_touch_is_visited_once() {
        for subdivisions in 0..4 {
            let mesh = Mesh::icosphere(1.0, subdivisions).unwrap();
            let found = Mutex::new(Vec::new());
            BoxTree::new(&mesh, 0.01).for_each_pair(|a, b| {
                found.lock().unwrap().push((a.min(b), a.max(b)));
                true
            });
            let mut found = found.into_inner().unwrap();
            found.sort_unstable();
            let box_of = |t: usize| {
                let [a, b, c] = mesh.corners(t);
                Box32::around(a.min(b).min(c) - 0.01, a.max(b).max(c) + 0.01)
            };
            let count = mesh.triangles().len();
            let all = (0..count).flat_map(|a| (a + 1..count).map(move |b| (a, b)));
            let touching = all.filter(|&(a, b)| box_of(a).touches(&box_of(b)));
            let expected: Vec<_> = touching.map(|(a, b)| (a as u32, b as u32)).collect();
            assert_eq!(found, expected);
        }
    }
}
