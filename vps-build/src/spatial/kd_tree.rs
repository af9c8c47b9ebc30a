//! A k-d tree with removal of points.

use glamx::DVec3;

/// Maximum points of a leaf.
const LEAF_SIZE: usize = 8;

/// A k-d tree over points. Each point is present until it is removed.
pub(crate) struct KdTree<'p> {
    points: &'p [DVec3],
    /// Point indices in tree order: every node holds a range.
    order: Vec<u32>,
    /// A complete binary tree: the children of node i are 2i + 1 and 2i + 2.
    nodes: Vec<Node>,
    /// The leaf of each point.
    leaf_of: Vec<u32>,
    present: Vec<bool>,
}

struct Node {
    start: u32,
    end: u32,
    low: DVec3,
    high: DVec3,
    present: u32,
}

impl<'p> KdTree<'p> {
    pub(crate) fn new(points: &'p [DVec3]) -> Self {
        let mut depth = 0;
        while points.len() >> depth > LEAF_SIZE {
            depth += 1;
        }
        let mut tree = Self {
            points,
            order: (0..points.len() as u32).collect(),
            nodes: Vec::with_capacity((2 << depth) - 1),
            leaf_of: vec![0; points.len()],
            present: vec![true; points.len()],
        };
        let first_leaf = (1 << depth) - 1;
        for i in 0..2 * first_leaf + 1 {
            let (start, end) = match i {
                0 => (0, points.len()),
                _ => {
                    let parent = &tree.nodes[(i - 1) / 2];
                    let (start, end) = (parent.start as usize, parent.end as usize);
                    let middle = usize::midpoint(start, end);
                    if i % 2 == 1 {
                        (start, middle)
                    } else {
                        (middle, end)
                    }
                }
            };
            let range = &mut tree.order[start..end];
            let empty = (DVec3::INFINITY, DVec3::NEG_INFINITY);
            let (low, high) = range.iter().fold(empty, |(low, high), &p| {
                let point = points[p as usize];
                (low.min(point), high.max(point))
            });
            if i >= first_leaf {
                for &p in &*range {
                    tree.leaf_of[p as usize] = i as u32;
                }
            } else {
                let axis = (high - low).max_position();
                let middle = range.len() / 2;
                // Ties are broken by index, so the tree is deterministic.
                range.select_nth_unstable_by(middle, |&a, &b| {
                    let along = |p: u32| points[p as usize][axis];
                    along(a).total_cmp(&along(b)).then(a.cmp(&b))
                });
            }
            tree.nodes.push(Node {
                start: start as u32,
                end: end as u32,
                low,
                high,
                present: (end - start) as u32,
            });
        }
        tree
    }

    pub(crate) fn remove(&mut self, point: usize) {
        if !std::mem::replace(&mut self.present[point], false) {
            return;
        }
        let mut node = self.leaf_of[point] as usize;
        loop {
            self.nodes[node].present -= 1;
            if node == 0 {
                break;
            }
            node = (node - 1) / 2;
        }
    }

    /// The `count` present points closest to `to`, or fewer, closest first. Ties go to the lowest
    /// index.
    pub(crate) fn closest(&self, to: DVec3, count: usize) -> Vec<usize> {
        if count == 0 {
            return Vec::new();
        }
        let mut found: Vec<(f64, u32)> = Vec::with_capacity(count + 1);
        self.search(0, to, count, &mut found);
        found.into_iter().map(|(_, p)| p as usize).collect()
    }

    fn search(&self, node: usize, to: DVec3, count: usize, found: &mut Vec<(f64, u32)>) {
        let this = &self.nodes[node];
        if 2 * node + 1 >= self.nodes.len() {
            for &p in &self.order[this.start as usize..this.end as usize] {
                if self.present[p as usize] {
                    let entry = (to.distance_squared(self.points[p as usize]), p);
                    if found.len() == count && found.last().is_some_and(|worst| *worst < entry) {
                        continue;
                    }
                    let at = found.partition_point(|e| *e < entry);
                    found.insert(at, entry);
                    found.truncate(count);
                }
            }
            return;
        }
        let gap = |i: usize| {
            let node = &self.nodes[i];
            to.distance_squared(to.clamp(node.low, node.high))
        };
        let mut children = [2 * node + 1, 2 * node + 2].map(|i| (gap(i), i));
        if children[1].0 < children[0].0 {
            children.swap(0, 1);
        }
        for (gap, child) in children {
            let is_closer = found.len() < count || found.last().is_some_and(|worst| gap <= worst.0);
            if is_closer && self.nodes[child].present > 0 {
                self.search(child, to, count, found);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn finds_what_a_scan_finds(
            points in prop::collection::vec(prop::array::uniform3(0..6_i32), 1..80),
            removed in prop::collection::vec(any::<prop::sample::Index>(), 0..60),
            to in prop::array::uniform3(-1.0..7.0_f64),
            count in 0..9_usize,
        ) {
            let points: Vec<_> = points.iter().map(|p| DVec3::from_array(p.map(f64::from))).collect();
            let to = DVec3::from_array(to);
            let mut tree = KdTree::new(&points);
            let mut left: Vec<_> = (0..points.len()).collect();
            for index in removed {
                let point = index.index(points.len());
                tree.remove(point);
                left.retain(|&p| p != point);
            }
            left.sort_by(|&a, &b| {
                let distance = |p: usize| to.distance_squared(points[p]);
                distance(a).total_cmp(&distance(b)).then(a.cmp(&b))
            });
            left.truncate(count);
            prop_assert_eq!(tree.closest(to, count), left);
        }
    }
}
