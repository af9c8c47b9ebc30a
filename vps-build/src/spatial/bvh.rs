//! The closest point of a mesh, by a bounding volume hierarchy of thick discs.
//!
//! A small part of a surface is nearly flat. The distance to a disc as thick as the part is curved
//! bounds the distance to the part to second order. A box or a ball is off by half of its size. For a
//! distant point, that decides between visiting a few triangles and hundreds.

use glamx::{DVec3, Vec4};
use rayon::prelude::*;
use vps_core::Vec3;

use crate::mesh::Mesh;
use crate::mesh::triangle::closest_point;

/// Packs of four discs per node. The discs of a pack are tested together.
const PACKS: usize = 4;

/// Children of a node.
const WIDTH: usize = 4 * PACKS;

/// DiscPack discs, coordinate by coordinate.
#[derive(Clone, Copy)]
struct DiscPack {
    center: [Vec4; 3],
    /// Unit axis, or zero for a ball.
    axis: [Vec4; 3],
    radius: Vec4,
    half_height: Vec4,
}

/// A node: bounds and indices of its children.
#[derive(Clone, Copy)]
struct Node {
    discs: [DiscPack; PACKS],
    children: [u32; WIDTH],
}

/// Set in a child index that is a triangle slot.
const LEAF_BIT: u32 = 1 << 31;

/// Triangles from which a subtree is built as a task of its own.
const PARALLEL_TRIANGLES: usize = 2048;

/// Most triangles for which a disc is fitted to every corner.
const MAX_FITTED: usize = 256;

/// Finds the triangle of a mesh closest to a point.
pub(crate) struct Bvh {
    /// The centre of the mesh. Discs are stored relative to it, in 32 bits.
    origin: DVec3,
    nodes: Vec<Node>,
    /// Corners of all triangles in tree order.
    corners: Vec<[DVec3; 3]>,
    /// The mesh triangle of each slot.
    triangles: Vec<u32>,
    /// The slot of each mesh triangle.
    slots: Vec<u32>,
}

/// The point of a mesh closest to a query point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Closest {
    /// Distance in metres, never negative.
    pub(crate) distance: f64,
    pub(crate) point: DVec3,
    /// Its triangle; of equally close ones the lowest index.
    pub(crate) triangle: u32,
}

impl Bvh {
    pub(crate) fn new(mesh: &Mesh) -> Self {
        let (low, high) = mesh.bounds();
        let origin = low.midpoint(high);
        let centred = &Centred { mesh, origin };
        let mut items: Vec<_> = (0..mesh.triangles().len())
            .map(|t| BoundedTriangle::new(centred, t))
            .collect();
        let mut nodes = Vec::new();
        build_subtree(centred, &mut items, 0, &mut nodes);
        let triangles: Vec<u32> = items.iter().map(|item| item.triangle).collect();
        let mut slots = vec![0; triangles.len()];
        for (slot, &triangle) in triangles.iter().enumerate() {
            slots[triangle as usize] = slot as u32;
        }
        Self {
            origin,
            nodes,
            corners: triangles
                .iter()
                .map(|&t| mesh.corners(t as usize))
                .collect(),
            triangles,
            slots,
        }
    }

    /// The closest point, exact up to f64 rounding. `guess` is a triangle of the mesh; a close one
    /// speeds up the search.
    pub(crate) fn closest(&self, point: DVec3, guess: u32) -> Closest {
        let on_slot = |slot: usize| {
            let on = closest_point(self.corners[slot], point);
            (point.distance_squared(on), on)
        };
        let (squared, on) = on_slot(self.slots[guess as usize] as usize);
        let mut best = (squared, on, guess);
        let from_origin = point - self.origin;
        let at = from_origin.as_vec3().to_array().map(Vec4::splat);
        // Discs beyond this squared 32-bit distance hold nothing closer.
        let rounding = 4.0 * f64::from(f32::EPSILON) * from_origin.abs().max_element();
        let pruning_limit = |squared: f64| {
            let distance = squared.sqrt() + rounding;
            (distance * distance * (1.0 + 1e-5)) as f32 + f32::MIN_POSITIVE
        };
        let mut limit = pruning_limit(best.0);
        // Each level leaves the siblings of one node; 2^31 triangles make at most 8 levels.
        let mut stack = [(0.0_f32, 0_u32); 8 * WIDTH];
        let mut top = 1;
        while top > 0 {
            top -= 1;
            let (least, node) = stack[top];
            if least > limit {
                continue;
            }
            let node = &self.nodes[node as usize];
            let distances = node.discs.map(|discs| discs.squared_distances(at));
            let mut hits = 0;
            for (i, four) in distances.iter().enumerate() {
                hits |= four.cmple(Vec4::splat(limit)).bitmask() << (4 * i);
            }
            let bottom = top;
            while hits != 0 {
                let lane = hits.trailing_zeros() as usize;
                hits &= hits - 1;
                let child = node.children[lane];
                let distance = distances[lane / 4][lane % 4];
                // A triangle visited since may have been closer.
                if distance > limit {
                    continue;
                }
                if child & LEAF_BIT == 0 {
                    // The closest child goes on top.
                    let mut slot = top;
                    while slot > bottom && stack[slot - 1].0 < distance {
                        stack[slot] = stack[slot - 1];
                        slot -= 1;
                    }
                    stack[slot] = (distance, child);
                    top += 1;
                    continue;
                }
                let slot = (child & !LEAF_BIT) as usize;
                let triangle = self.triangles[slot];
                let (squared, on) = on_slot(slot);
                if squared < best.0 || squared == best.0 && triangle < best.2 {
                    best = (squared, on, triangle);
                    limit = pruning_limit(squared);
                }
            }
        }
        Closest {
            distance: best.0.sqrt(),
            point: best.1,
            triangle: best.2,
        }
    }
}

impl DiscPack {
    /// Absent children: infinitely far.
    const EMPTY: Self = Self {
        center: [Vec4::ZERO; 3],
        axis: [Vec4::ZERO; 3],
        radius: Vec4::NEG_INFINITY,
        half_height: Vec4::ZERO,
    };

    #[inline(always)]
    fn squared_distances(&self, point: [Vec4; 3]) -> Vec4 {
        let [x, y, z] = [0, 1, 2].map(|a| point[a] - self.center[a]);
        let along = x * self.axis[0] + y * self.axis[1] + z * self.axis[2];
        let squared = x * x + y * y + z * z;
        let above = (along.abs() - self.half_height).max(Vec4::ZERO);
        let across = (squared - along * along).max(Vec4::ZERO).sqrt();
        let beside = (across - self.radius).max(Vec4::ZERO);
        above * above + beside * beside
    }

    fn set(&mut self, lane: usize, disc: &Disc) {
        for axis in 0..3 {
            self.center[axis][lane] = disc.center.to_array()[axis] as f32;
            self.axis[axis][lane] = disc.axis.to_array()[axis] as f32;
        }
        // The height above the disc is a difference, and the distance beside it the root of one.
        // 32-bit rounding loses less than this, unless the disc is a needle.
        let radius = disc.radius.max(0.1 * disc.half_height);
        let size = radius + disc.half_height + disc.center.abs().max_element() * 1e-3;
        self.radius[lane] = (radius + 3e-4 * size) as f32;
        self.half_height[lane] = (disc.half_height + 3e-5 * size) as f32;
    }
}

impl Node {
    const EMPTY: Self = Self {
        discs: [DiscPack::EMPTY; PACKS],
        children: [LEAF_BIT; WIDTH],
    };
}

/// All points within `half_height` of the plane through `center` normal to `axis`, and within
/// `radius` of the axis.
struct Disc {
    center: DVec3,
    axis: DVec3,
    radius: f64,
    half_height: f64,
}

impl Disc {
    /// Bounds triangles: along their mean normal, or as the ball around their box if they are many.
    fn around(centred: &Centred<'_>, items: &[BoundedTriangle]) -> Self {
        let (low, high) = bounds(items);
        let (low, high) = (low.as_dvec3(), high.as_dvec3());
        let (center, half) = (low.midpoint(high), (high - low) * 0.5);
        if items.len() > MAX_FITTED {
            return Self {
                center,
                axis: DVec3::ZERO,
                radius: half.length(),
                half_height: 0.0,
            };
        }
        let corners = || {
            items
                .iter()
                .map(|item| centred.corners(item.triangle as usize))
        };
        let axis: DVec3 = corners().map(|[a, b, c]| (b - a).cross(c - a)).sum();
        let axis = axis.normalize_or_zero();
        let (mut lowest, mut highest, mut radius) = (f64::INFINITY, f64::NEG_INFINITY, 0.0_f64);
        for corner in corners().flatten() {
            let offset = corner - center;
            let height = offset.dot(axis);
            lowest = lowest.min(height);
            highest = highest.max(height);
            radius = radius.max(offset.length_squared() - height * height);
        }
        Self {
            center: center + axis * lowest.midpoint(highest),
            axis,
            radius: radius.max(0.0).sqrt(),
            half_height: 0.5 * (highest - lowest),
        }
    }
}

/// A mesh relative to its centre.
struct Centred<'m> {
    mesh: &'m Mesh,
    origin: DVec3,
}

impl Centred<'_> {
    fn corners(&self, triangle: usize) -> [DVec3; 3] {
        self.mesh.corners(triangle).map(|v| v - self.origin)
    }
}

/// A triangle during the build.
#[derive(Clone, Copy)]
struct BoundedTriangle {
    low: Vec3,
    high: Vec3,
    triangle: u32,
}

impl BoundedTriangle {
    fn new(centred: &Centred<'_>, triangle: usize) -> Self {
        let [a, b, c] = centred.corners(triangle).map(DVec3::as_vec3);
        Self {
            low: a.min(b).min(c),
            high: a.max(b).max(c),
            triangle: triangle as u32,
        }
    }
}

/// The box around the triangles, rounded to 32 bits.
fn bounds(items: &[BoundedTriangle]) -> (Vec3, Vec3) {
    let empty = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    items.iter().fold(empty, |(low, high), item| {
        (low.min(item.low), high.max(item.high))
    })
}

/// Sorts the triangles of a subtree and appends its nodes, the root first.
fn build_subtree(
    centred: &Centred<'_>,
    items: &mut [BoundedTriangle],
    first: usize,
    nodes: &mut Vec<Node>,
) {
    let root = nodes.len();
    nodes.push(Node::EMPTY);
    let mut parts = vec![items];
    while parts.len() < WIDTH {
        parts = parts.into_iter().flat_map(split_at_median).collect();
    }
    let is_large = parts[0].len() >= PARALLEL_TRIANGLES;
    let mut start = first;
    let with_start = |part: &'_ &mut [BoundedTriangle]| {
        start += part.len();
        start - part.len()
    };
    let starts: Vec<usize> = parts.iter().map(with_start).collect();
    let mut subtrees = vec![Vec::new(); WIDTH];
    if is_large {
        let parts = parts.par_iter_mut().zip(&starts).zip(&mut subtrees);
        parts.for_each(|((part, &start), nodes)| build_subtree(centred, part, start, nodes));
    }
    for (lane, ((part, start), mut made)) in parts.into_iter().zip(starts).zip(subtrees).enumerate()
    {
        if part.is_empty() {
            continue;
        }
        let offset = nodes.len() as u32;
        nodes[root].discs[lane / 4].set(lane % 4, &Disc::around(centred, part));
        nodes[root].children[lane] = match part {
            [_] => LEAF_BIT | start as u32,
            _ => offset,
        };
        if is_large {
            for child in made.iter_mut().flat_map(|node| &mut node.children) {
                if *child & LEAF_BIT == 0 {
                    *child += offset;
                }
            }
            nodes.append(&mut made);
        } else if part.len() > 1 {
            build_subtree(centred, part, start, nodes);
        }
    }
}

/// Splits at the median of the axis of largest extent.
fn split_at_median(items: &mut [BoundedTriangle]) -> [&mut [BoundedTriangle]; 2] {
    let half = items.len().div_ceil(2);
    if half < items.len() {
        let empty = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        let middle = |item: &BoundedTriangle| item.low + item.high;
        let (low, high) = items.iter().fold(empty, |(low, high), item| {
            (low.min(middle(item)), high.max(middle(item)))
        });
        let axis = (high - low).max_position();
        items.select_nth_unstable_by(half, |a, b| {
            let by_middle = middle(a)[axis].total_cmp(&middle(b)[axis]);
            by_middle.then(a.triangle.cmp(&b.triangle))
        });
    }
    items.split_at_mut(half).into()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn soup() -> impl Strategy<Value = Mesh> {
        let corner = prop::array::uniform3(-1.0..1.0_f64).prop_map(DVec3::from_array);
        let size = prop_oneof![Just(0.05), Just(1.0)];
        (
            prop::collection::vec((corner.clone(), corner.clone(), corner), 1..200),
            size,
        )
            .prop_map(|(triangles, size)| {
                let corners = |&(a, b, c): &(DVec3, DVec3, DVec3)| [a, a + b * size, a + c * size];
                let vertices: Vec<_> = triangles.iter().flat_map(corners).collect();
                let triangles: Vec<_> = (0..triangles.len() as u32)
                    .map(|t| [3 * t, 3 * t + 1, 3 * t + 2])
                    .collect();
                Mesh::new(&vertices, &triangles).unwrap()
            })
    }

    proptest! {
        #[test]
        fn the_closest_of_all_triangles_is_found(
            mesh in soup(),
            points in prop::collection::vec(prop::array::uniform3(-2.0..2.0_f64), 20),
            guess in any::<prop::sample::Index>(),
        ) {
            let bvh = Bvh::new(&mesh);
            let count = mesh.triangles().len();
            for point in points.into_iter().map(DVec3::from_array) {
                let found = bvh.closest(point, guess.index(count) as u32);
                let distance = |t| closest_point(mesh.corners(t), point).distance(point);
                let least = (0..count).map(distance).fold(f64::INFINITY, f64::min);
                prop_assert_eq!(found.distance, least);
                prop_assert_eq!(found.distance, distance(found.triangle as usize));
                prop_assert_eq!(found.distance, found.point.distance(point));
            }
        }
    }

    #[test]
    fn many_triangles_make_a_tree_of_all() {
        // Enough for parallel subtrees.
        let mesh = Mesh::icosphere(1.0, 6).unwrap();
        let bvh = Bvh::new(&mesh);
        let children = bvh.nodes.iter().flat_map(|node| {
            let filled = |&lane: &usize| node.discs[lane / 4].radius[lane % 4].is_finite();
            (0..WIDTH).filter(filled).map(|lane| node.children[lane])
        });
        let mut seen: Vec<_> = children
            .filter(|c| c & LEAF_BIT != 0)
            .map(|c| c & !LEAF_BIT)
            .collect();
        seen.sort_unstable();
        assert!(seen.iter().copied().eq(0..mesh.triangles().len() as u32));
        for i in 0..500 {
            let t = i * 163 % mesh.triangles().len();
            let [a, b, c] = mesh.corners(t);
            let middle = (a + b + c) / 3.0;
            assert_eq!(bvh.closest(middle * 1.1, 0).triangle, t as u32);
        }
    }
}
