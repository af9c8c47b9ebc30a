//! The closest point of a mesh, by a tree of thick discs.
//!
//! A small part of a surface is nearly flat. A disc as thick as the part is curved says how close
//! the part can be up to second order, where a box or a ball is wrong by half of its size: for a
//! point far away, that is the difference between a few triangles and hundreds.

use glamx::{DVec3, Vec4};
use rayon::prelude::*;
use vps_core::Vec3;

use crate::Mesh;
use crate::triangle::closest_point;

/// Discs are tested four at a time, and this many fours make a node.
const FOURS: usize = 4;

/// How many children a node has.
const WIDTH: usize = 4 * FOURS;

/// Four discs, coordinate by coordinate.
#[derive(Clone, Copy)]
struct Four {
    center: [Vec4; 3],
    /// Of length one, or zero, which makes a ball of the disc.
    axis: [Vec4; 3],
    radius: Vec4,
    half_height: Vec4,
}

/// The children of one place in the tree.
#[derive(Clone, Copy)]
struct Node {
    discs: [Four; FOURS],
    children: [u32; WIDTH],
}

/// This bit of a child says that it is a triangle; no child is a node below itself.
const TRIANGLE: u32 = 1 << 31;

/// From how many triangles on a subtree is worth a task of its own.
const PARALLEL: usize = 2048;

/// Up to how many triangles a disc is fitted to each of them.
const FITTED: usize = 256;

/// Finds the triangle of a mesh that is closest to a point.
pub(crate) struct Bvh {
    /// The discs are given from here, the middle of the mesh, in 32 bits.
    origin: DVec3,
    nodes: Vec<Node>,
    /// Corners of all triangles, close to each other where the triangles are.
    corners: Vec<[DVec3; 3]>,
    /// Which triangle of the mesh each of them is.
    triangles: Vec<u32>,
    /// Where each triangle of the mesh is among them.
    slots: Vec<u32>,
}

/// The point of a mesh that is closest to another point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Closest {
    /// How far it is, in metres.
    pub(crate) distance: f64,
    pub(crate) point: DVec3,
    /// The triangle it lies on; the lowest if there are several.
    pub(crate) triangle: u32,
}

impl Bvh {
    pub(crate) fn new(mesh: &Mesh) -> Self {
        let (low, high) = mesh.bounds();
        let origin = low.midpoint(high);
        let about = &About { mesh, origin };
        let mut items: Vec<_> = (0..mesh.triangles().len())
            .map(|t| Item::new(about, t))
            .collect();
        let mut nodes = Vec::new();
        subtree(about, &mut items, 0, &mut nodes);
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

    /// The closest point, exact but for rounding to f64. The better the guess, a triangle of the
    /// mesh, the faster.
    pub(crate) fn closest(&self, point: DVec3, guess: u32) -> Closest {
        let on_slot = |slot: usize| {
            let on = closest_point(self.corners[slot], point);
            (point.distance_squared(on), on)
        };
        let (squared, on) = on_slot(self.slots[guess as usize] as usize);
        let mut best = (squared, on, guess);
        let from_origin = point - self.origin;
        let at = from_origin.as_vec3().to_array().map(Vec4::splat);
        // Discs further away, in squared 32-bit numbers, hold nothing closer.
        let rounding = 4.0 * f64::from(f32::EPSILON) * from_origin.abs().max_element();
        let pruning_limit = |squared: f64| {
            let distance = squared.sqrt() + rounding;
            (distance * distance * (1.0 + 1e-5)) as f32 + f32::MIN_POSITIVE
        };
        let mut limit = pruning_limit(best.0);
        // Each level leaves the siblings of one node, and 2^31 triangles are no more than 8 levels.
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
                // A triangle before it may have been closer.
                if distance > limit {
                    continue;
                }
                if child & TRIANGLE == 0 {
                    // The closest goes on top.
                    let mut place = top;
                    while place > bottom && stack[place - 1].0 < distance {
                        stack[place] = stack[place - 1];
                        place -= 1;
                    }
                    stack[place] = (distance, child);
                    top += 1;
                    continue;
                }
                let slot = (child & !TRIANGLE) as usize;
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

impl Four {
    /// Of children that do not exist: infinitely far.
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
        // The height above the disc is a difference, and the way beside it the root of one. What
        // 32 bits lose there is less than this, unless the disc is a needle.
        let radius = disc.radius.max(0.1 * disc.half_height);
        let size = radius + disc.half_height + disc.center.abs().max_element() * 1e-3;
        self.radius[lane] = (radius + 3e-4 * size) as f32;
        self.half_height[lane] = (disc.half_height + 3e-5 * size) as f32;
    }
}

impl Node {
    const EMPTY: Self = Self {
        discs: [Four::EMPTY; FOURS],
        children: [TRIANGLE; WIDTH],
    };
}

/// All points no further than `half_height` from the plane through `center` across `axis`, and no
/// further than `radius` from the line.
struct Disc {
    center: DVec3,
    axis: DVec3,
    radius: f64,
    half_height: f64,
}

impl Disc {
    /// Around some triangles: across their mean normal, or around their box if they are many.
    fn around(about: &About<'_>, items: &[Item]) -> Self {
        let (low, high) = bounds(items);
        let (low, high) = (low.as_dvec3(), high.as_dvec3());
        let (center, half) = (low.midpoint(high), (high - low) * 0.5);
        if items.len() > FITTED {
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
                .map(|item| about.corners(item.triangle as usize))
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

/// A mesh seen from its middle.
struct About<'m> {
    mesh: &'m Mesh,
    origin: DVec3,
}

impl About<'_> {
    fn corners(&self, triangle: usize) -> [DVec3; 3] {
        self.mesh.corners(triangle).map(|v| v - self.origin)
    }
}

/// A triangle while the tree is made.
#[derive(Clone, Copy)]
struct Item {
    low: Vec3,
    high: Vec3,
    triangle: u32,
}

impl Item {
    fn new(about: &About<'_>, triangle: usize) -> Self {
        let [a, b, c] = about.corners(triangle).map(DVec3::as_vec3);
        Self {
            low: a.min(b).min(c),
            high: a.max(b).max(c),
            triangle: triangle as u32,
        }
    }
}

/// The box around the triangles, its coordinates rounded.
fn bounds(items: &[Item]) -> (Vec3, Vec3) {
    let nothing = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    items.iter().fold(nothing, |(low, high), item| {
        (low.min(item.low), high.max(item.high))
    })
}

/// Sorts the triangles of a subtree and appends its nodes, the root first.
fn subtree(about: &About<'_>, items: &mut [Item], first: usize, nodes: &mut Vec<Node>) {
    let root = nodes.len();
    nodes.push(Node::EMPTY);
    let mut parts = vec![items];
    while parts.len() < WIDTH {
        parts = parts.into_iter().flat_map(halve).collect();
    }
    let is_large = parts[0].len() >= PARALLEL;
    let mut start = first;
    let with_start = |part: &'_ &mut [Item]| {
        start += part.len();
        start - part.len()
    };
    let starts: Vec<usize> = parts.iter().map(with_start).collect();
    let mut subtrees = vec![Vec::new(); WIDTH];
    if is_large {
        let parts = parts.par_iter_mut().zip(&starts).zip(&mut subtrees);
        parts.for_each(|((part, &start), nodes)| subtree(about, part, start, nodes));
    }
    for (lane, ((part, start), mut made)) in parts.into_iter().zip(starts).zip(subtrees).enumerate()
    {
        if part.is_empty() {
            continue;
        }
        let offset = nodes.len() as u32;
        nodes[root].discs[lane / 4].set(lane % 4, &Disc::around(about, part));
        nodes[root].children[lane] = match part {
            [_] => TRIANGLE | start as u32,
            _ => offset,
        };
        if is_large {
            for child in made.iter_mut().flat_map(|node| &mut node.children) {
                if *child & TRIANGLE == 0 {
                    *child += offset;
                }
            }
            nodes.append(&mut made);
        } else if part.len() > 1 {
            subtree(about, part, start, nodes);
        }
    }
}

/// Two halves along the axis on which the triangles spread furthest.
fn halve(items: &mut [Item]) -> [&mut [Item]; 2] {
    let half = items.len().div_ceil(2);
    if half < items.len() {
        let nothing = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        let middle = |item: &Item| item.low + item.high;
        let (low, high) = items.iter().fold(nothing, |(low, high), item| {
            (low.min(middle(item)), high.max(middle(item)))
        });
        let axis = (high - low).max_position();
        items.select_nth_unstable_by(half, |a, b| {
            let by_place = middle(a)[axis].total_cmp(&middle(b)[axis]);
            by_place.then(a.triangle.cmp(&b.triangle))
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
        // Enough for subtrees of their own tasks.
        let mesh = Mesh::icosphere(1.0, 6).unwrap();
        let bvh = Bvh::new(&mesh);
        let children = bvh.nodes.iter().flat_map(|node| {
            let filled = |&lane: &usize| node.discs[lane / 4].radius[lane % 4].is_finite();
            (0..WIDTH).filter(filled).map(|lane| node.children[lane])
        });
        let mut seen: Vec<_> = children
            .filter(|c| c & TRIANGLE != 0)
            .map(|c| c & !TRIANGLE)
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
