//! A tree of boxes over facets, to find the one closest to a point.

use std::sync::atomic::{AtomicUsize, Ordering};

use vps_core::{Aabb, Vec3};

use super::facet::Facet;

/// Facets in the leaves of a binary tree of boxes.
pub(crate) struct FacetTree {
    facets: Vec<Facet>,
    nodes: Vec<Node>,
    /// The facet closest to the previous point, which bounds the distance for the next.
    previous: AtomicUsize,
}

/// A box around consecutive facets.
struct Node {
    bounds: Aabb,
    /// Index of the first facet in a leaf, of the first of two child nodes otherwise.
    first: u32,
    /// Number of facets in a leaf, 0 otherwise.
    count: u32,
}

/// Most facets of a leaf.
const LEAF_SIZE: usize = 4;

/// Factor by which a squared distance may be off by rounding, with room to spare.
const ROUNDING_FACTOR: f32 = 1.0 + 1e-4;

/// Depth of the traversal stack, enough for any number of facets.
const STACK_SIZE: usize = 64;

/// The point of a surface closest to another point.
#[derive(Clone, Copy)]
pub(crate) struct ClosestPoint {
    /// Squared distance in m².
    pub(crate) squared: f32,
    /// Index of the facet in the tree.
    pub(crate) facet: usize,
    pub(crate) feature: Feature,
    pub(crate) point: Vec3,
}

/// The part of a facet a point lies on.
#[derive(Clone, Copy)]
pub(crate) enum Feature {
    Face,
    Edge(usize),
    Vertex(usize),
}

impl FacetTree {
    pub(crate) fn new(mut facets: Vec<Facet>) -> Self {
        let mut nodes = Vec::new();
        if !facets.is_empty() {
            nodes.push(Node::of(&facets, 0));
            divide(&mut nodes, 0, &mut facets, 0);
        }
        Self {
            facets,
            nodes,
            previous: AtomicUsize::new(0),
        }
    }

    /// The facets in the order of the leaves.
    pub(crate) fn facets(&self) -> &[Facet] {
        &self.facets
    }

    /// The closest point of all facets; `None` if there are none.
    pub(crate) fn closest(&self, point: Vec3) -> Option<ClosestPoint> {
        // The closest point is no further away than the facet found for the previous point. Which
        // facet that was must not decide between two at the same distance up to rounding.
        let previous = self.facets.get(self.previous.load(Ordering::Relaxed))?;
        let mut limit = previous.closest(point, 0).squared * ROUNDING_FACTOR + f32::MIN_POSITIVE;
        let mut best: Option<ClosestPoint> = None;
        let mut stack = [0_u32; STACK_SIZE];
        let mut left = 1;
        while left > 0 {
            left -= 1;
            let node = &self.nodes[stack[left] as usize];
            if node.squared_distance(point) >= limit {
                continue;
            }
            if node.count > 0 {
                let range = node.first as usize..(node.first + node.count) as usize;
                for index in range {
                    let facet = &self.facets[index];
                    let height = facet.height(point);
                    // No point of a triangle is closer than its plane.
                    if height * height < limit {
                        let found = facet.closest(point, index);
                        if found.squared < limit {
                            (best, limit) = (Some(found), found.squared);
                        }
                    }
                }
                continue;
            }
            let [mut near, mut far] = [node.first, node.first + 1];
            let squared = |index: u32| self.nodes[index as usize].squared_distance(point);
            if squared(far) < squared(near) {
                (near, far) = (far, near);
            }
            stack[left] = far;
            stack[left + 1] = near;
            left += 2;
        }
        if let Some(best) = &best {
            self.previous.store(best.facet, Ordering::Relaxed);
        }
        best
    }

    /// Visits the facets of all leaves within a distance, given as its square, until `visit` returns
    /// `false`.
    pub(crate) fn for_each_within(
        &self,
        point: Vec3,
        squared: f32,
        mut visit: impl FnMut(&Facet) -> bool,
    ) {
        let mut stack = [0_u32; STACK_SIZE];
        let mut left = usize::from(!self.nodes.is_empty());
        while left > 0 {
            left -= 1;
            let node = &self.nodes[stack[left] as usize];
            if node.squared_distance(point) > squared {
                continue;
            }
            if node.count == 0 {
                stack[left] = node.first;
                stack[left + 1] = node.first + 1;
                left += 2;
                continue;
            }
            let range = node.first as usize..(node.first + node.count) as usize;
            for facet in &self.facets[range] {
                if !visit(facet) {
                    return;
                }
            }
        }
    }
}

impl Node {
    fn of(facets: &[Facet], first: usize) -> Self {
        let boxes = facets.iter().map(Facet::bounds);
        let all = boxes.reduce(|a, b| Aabb {
            min: a.min.min(b.min),
            max: a.max.max(b.max),
        });
        Self {
            bounds: all.unwrap_or(Aabb {
                min: Vec3::ZERO,
                max: Vec3::ZERO,
            }),
            first: first as u32,
            count: facets.len() as u32,
        }
    }

    /// Squared distance of a point from the box.
    fn squared_distance(&self, point: Vec3) -> f32 {
        (self.bounds.clamp(point) - point).length_squared()
    }
}

/// Divides a node recursively at the median along its longest axis; `first` is the index of its first
/// facet.
fn divide(nodes: &mut Vec<Node>, node: usize, facets: &mut [Facet], first: usize) {
    if facets.len() <= LEAF_SIZE {
        return;
    }
    let extents = nodes[node].bounds.extents();
    let axis = (0..3).fold(0, |a, b| if extents[b] > extents[a] { b } else { a });
    let half = facets.len() / 2;
    let at = |f: &Facet| f.corners[0][axis] + f.corners[1][axis] + f.corners[2][axis];
    facets.select_nth_unstable_by(half, |f, g| {
        at(f).total_cmp(&at(g)).then(f.number.cmp(&g.number))
    });
    let (low, high) = facets.split_at_mut(half);
    let child = nodes.len();
    nodes.push(Node::of(low, first));
    nodes.push(Node::of(high, first + half));
    (nodes[node].first, nodes[node].count) = (child as u32, 0);
    divide(nodes, child, low, first);
    divide(nodes, child + 1, high, first + half);
}

impl Facet {
    /// The closest of its points; `facet` is the index the result is to have.
    fn closest(&self, point: Vec3, facet: usize) -> ClosestPoint {
        let (feature, closest) = closest_point(self.corners, self.normal, point);
        let squared = match feature {
            Feature::Face => self.height(point).powi(2),
            _ => point.distance_squared(closest),
        };
        ClosestPoint {
            squared,
            facet,
            feature,
            point: closest,
        }
    }
}

/// The point of a triangle with a unit normal closest to `p`: the projection on its plane if that lies
/// within all edges, otherwise a point of an edge that `p` is beyond.
fn closest_point(corners: [Vec3; 3], normal: Vec3, p: Vec3) -> (Feature, Vec3) {
    let mut best = (Feature::Face, p - normal * (p - corners[0]).dot(normal));
    let mut least = f32::INFINITY;
    for i in 0..3 {
        let (start, along) = (corners[i], corners[(i + 1) % 3] - corners[i]);
        let to_point = p - start;
        if along.cross(to_point).dot(normal) >= 0.0 {
            continue;
        }
        let (ahead, length) = (to_point.dot(along), along.length_squared());
        let found = if ahead <= 0.0 {
            (Feature::Vertex(i), start)
        } else if ahead >= length {
            (Feature::Vertex((i + 1) % 3), corners[(i + 1) % 3])
        } else {
            (Feature::Edge(i), start + along * (ahead / length))
        };
        let squared = p.distance_squared(found.1);
        if squared < least {
            (best, least) = (found, squared);
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use glamx::DVec3;
    use proptest::prelude::*;

    use super::*;

    fn vector() -> impl Strategy<Value = Vec3> {
        prop::array::uniform3(-1.0..1.0_f32).prop_map(Vec3::from)
    }

    proptest! {
        /// As in double precision, also for slivers.
        #[test]
        fn the_closest_point_of_a_triangle_is_closest(
            a in vector(), b in vector(), third in vector(), p in vector(),
            width in prop_oneof![Just(1.0_f32), Just(1e-2), Just(1e-4), Just(1e-6)],
        ) {
            let corners = [a, b, a.midpoint(b) + third * width];
            let [u, v, w] = corners.map(Vec3::as_dvec3);
            let normal = (v - u).cross(w - u);
            prop_assume!(normal != DVec3::ZERO);
            let right = vps_build::closest_point([u, v, w], p.as_dvec3());
            let (_, found) = closest_point(corners, normal.normalize().as_vec3(), p);
            let [right, told] = [right, found.as_dvec3()].map(|q| q.distance(p.as_dvec3()));
            prop_assert!((right - told).abs() < 1e-5, "{right} {told}");
        }
    }
}
