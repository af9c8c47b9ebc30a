//! Which way the triangles of a surface face.

use glamx::DVec3;
use rustc_hash::FxHashMap;

use crate::Mesh;
use crate::edges::Edges;
use crate::health::UnionFind;
use crate::triangle::{area, signed_volume};
use crate::winding::Lines;

/// The parts of a closed surface that share no vertex.
pub(super) struct Parts {
    part_of: Vec<u32>,
    volumes: Vec<f64>,
    /// The largest triangle of each.
    largest: Vec<u32>,
}

impl Parts {
    pub(super) fn of(mesh: &Mesh) -> Self {
        let mut vertices = UnionFind::new(mesh.vertices().len());
        for &[a, b, c] in mesh.triangles() {
            vertices.join(a, b);
            vertices.join(b, c);
        }
        let (origin, _) = mesh.bounds();
        let mut numbers = FxHashMap::default();
        let mut parts = Self {
            part_of: Vec::with_capacity(mesh.triangles().len()),
            volumes: Vec::new(),
            largest: Vec::new(),
        };
        let mut areas = Vec::new();
        for (t, &[vertex, ..]) in mesh.triangles().iter().enumerate() {
            let next = parts.volumes.len() as u32;
            let part = *numbers.entry(vertices.root(vertex)).or_insert(next);
            if part == next {
                parts.volumes.push(0.0);
                parts.largest.push(t as u32);
                areas.push(0.0);
            }
            parts.part_of.push(part);
            let corners = mesh.corners(t);
            parts.volumes[part as usize] += signed_volume(corners, origin);
            let area = area(corners);
            if area > areas[part as usize] {
                areas[part as usize] = area;
                parts.largest[part as usize] = t as u32;
            }
        }
        parts
    }

    /// Whether each part has a positive volume.
    pub(super) fn face_outwards(&self) -> bool {
        self.volumes.iter().all(|&volume| volume >= 0.0)
    }

    /// Whether parts that do not touch are each the boundary of the solid: with nothing around those
    /// that face outwards, and one solid around those that face a cavity.
    pub(super) fn are_nested(&self, mesh: &Mesh) -> bool {
        if self.volumes.len() == 1 {
            return self.face_outwards();
        }
        let lines = Lines::new(mesh);
        (0..).zip(&self.volumes).all(|(part, &volume)| {
            let [a, b, c] = mesh.corners(self.largest[part as usize] as usize);
            let others = |t: u32| self.part_of[t as usize] != part;
            let around = lines.winding((a + b + c) / 3.0, others);
            around == i32::from(volume < 0.0)
        })
    }
}

/// Turns triangles until those with a common edge agree, most of each patch stays as it was, and
/// the outermost patches are not inside out; where one of these is turned, all within it are.
/// Returns how many were turned.
pub(super) fn turn_by_neighbours(mesh: &Mesh, triangles: &mut [[u32; 3]]) -> usize {
    let before = triangles.to_vec();
    let edges = Edges::of(triangles);
    let patches = Patches::of(triangles.len(), &edges);
    // Positive: the area that would stay as it is.
    let mut majority = vec![0.0; patches.count];
    for (t, &patch) in patches.patch_of.iter().enumerate() {
        let area = area(mesh.corners(t));
        majority[patch as usize] += if patches.turned[t] { -area } else { area };
    }
    for (t, &patch) in patches.patch_of.iter().enumerate() {
        if patches.turned[t] == (majority[patch as usize] >= 0.0) {
            triangles[t].reverse();
        }
    }
    let is_turned = |t: usize, triangles: &[[u32; 3]]| triangles[t] != before[t];
    let volumes = volumes(mesh, &patches, &edges, |t| is_turned(t, triangles));
    if volumes.iter().any(|&volume| volume < 0.0) {
        let sense = |t: usize| if is_turned(t, triangles) { -1 } else { 1 };
        let senses: Vec<i32> = (0..triangles.len()).map(sense).collect();
        let inside_out = inside_out(mesh, &patches, &volumes, &senses);
        for (triangle, &patch) in triangles.iter_mut().zip(&patches.patch_of) {
            if inside_out[patch as usize] {
                triangle.reverse();
            }
        }
    }
    (0..before.len())
        .filter(|&t| is_turned(t, triangles))
        .count()
}

/// The volume of each patch, closed from the middle of its rim.
fn volumes(
    mesh: &Mesh,
    patches: &Patches,
    edges: &Edges,
    is_turned: impl Fn(usize) -> bool,
) -> Vec<f64> {
    let mut rims = vec![(DVec3::ZERO, 0.0); patches.count];
    for edge in edges.groups().filter(|uses| uses.len() != 2).flatten() {
        let (from, to) = edge.between;
        let [from, to] = [from, to].map(|v| mesh.vertices()[v as usize]);
        let length = from.distance(to);
        let rim = &mut rims[patches.patch_of[edge.triangle as usize] as usize];
        rim.0 += from.midpoint(to) * length;
        rim.1 += length;
    }
    let (low, _) = mesh.bounds();
    let mut volumes = vec![0.0; patches.count];
    for (t, &patch) in patches.patch_of.iter().enumerate() {
        let (sum, length) = rims[patch as usize];
        let middle = if length > 0.0 { sum / length } else { low };
        let volume = signed_volume(mesh.corners(t), middle);
        volumes[patch as usize] += if is_turned(t) { -volume } else { volume };
    }
    volumes
}

/// Which patches are to be turned: the outermost ones of negative volume, and those within them. So
/// a mirrored body keeps its cavities.
fn inside_out(mesh: &Mesh, patches: &Patches, volumes: &[f64], senses: &[i32]) -> Vec<bool> {
    let lines = Lines::new(mesh);
    let mut a_triangle = vec![0; patches.count];
    for (t, &patch) in patches.patch_of.iter().enumerate().rev() {
        a_triangle[patch as usize] = t;
    }
    // Which other patches wind around each patch.
    let around = |patch: usize| {
        let [a, b, c] = mesh.corners(a_triangle[patch]);
        let mut windings: FxHashMap<u32, i32> = FxHashMap::default();
        lines.for_each_crossing((a + b + c) / 3.0, |t, change| {
            *windings.entry(patches.patch_of[t as usize]).or_default() +=
                change * senses[t as usize];
        });
        windings.remove(&(patch as u32));
        windings.retain(|_, winding| *winding != 0);
        let mut around: Vec<u32> = windings.into_keys().collect();
        around.sort_unstable();
        around
    };
    let around: Vec<Vec<u32>> = (0..patches.count).map(around).collect();
    let is_outermost = |&patch: &u32| around[patch as usize].is_empty();
    (0..patches.count)
        .map(|patch| {
            let outermost = around[patch].iter().copied().find(is_outermost);
            volumes[outermost.map_or(patch, |o| o as usize)] < 0.0
                && (outermost.is_some() || around[patch].is_empty())
        })
        .collect()
}

/// Triangles that hang together by edges with two triangles.
struct Patches {
    count: usize,
    patch_of: Vec<u32>,
    /// Whether a triangle turns another way than the first of its patch.
    turned: Vec<bool>,
}

impl Patches {
    fn of(triangles: usize, edges: &Edges) -> Self {
        const NONE: u32 = u32::MAX;
        // For each triangle its neighbours, and whether they agree.
        let mut neighbours = vec![[(NONE, true); 3]; triangles];
        for uses in edges.groups() {
            if let [a, b] = uses {
                let agree = a.forward != b.forward;
                for (this, other) in [(a, b), (b, a)] {
                    let free = neighbours[this.triangle as usize]
                        .iter_mut()
                        .find(|n| n.0 == NONE);
                    *free.expect("a triangle has three edges") = (other.triangle, agree);
                }
            }
        }
        let mut patches = Self {
            count: 0,
            patch_of: vec![NONE; triangles],
            turned: vec![false; triangles],
        };
        let mut open = Vec::new();
        for first in 0..triangles as u32 {
            if patches.patch_of[first as usize] != NONE {
                continue;
            }
            patches.patch_of[first as usize] = patches.count as u32;
            open.push(first);
            while let Some(t) = open.pop() {
                for &(other, agree) in &neighbours[t as usize] {
                    if other != NONE && patches.patch_of[other as usize] == NONE {
                        patches.patch_of[other as usize] = patches.count as u32;
                        patches.turned[other as usize] = patches.turned[t as usize] == agree;
                        open.push(other);
                    }
                }
            }
            patches.count += 1;
        }
        patches
    }
}
