//! Which way the triangles of a surface face.

use std::borrow::Cow;

use rayon::prelude::*;
use rustc_hash::FxHashMap;

use super::fans::Fans;
use super::holes;
use super::self_contact::gap;
use crate::Mesh;
use crate::edges::Edges;
use crate::health::UnionFind;
use crate::triangle::{area, middle, signed_volume};
use crate::winding::Lines;

/// The bodies that a closed surface bounds.
pub(super) struct Parts {
    part_of: Vec<u32>,
    volumes: Vec<f64>,
    /// The largest triangle of each.
    largest: Vec<u32>,
    are_clear: bool,
}

impl Parts {
    pub(super) fn of(mesh: &Mesh) -> Self {
        let fans = Fans::of(mesh, gap(mesh));
        let mut roots = UnionFind::new(fans.vertices.len());
        for &[a, b, c] in &fans.of_triangles {
            roots.join(a, b);
            roots.join(b, c);
        }
        let (origin, _) = mesh.bounds();
        let mut numbers = FxHashMap::default();
        let mut parts = Self {
            part_of: Vec::with_capacity(mesh.triangles().len()),
            volumes: Vec::new(),
            largest: Vec::new(),
            are_clear: fans.are_clear,
        };
        let mut areas = Vec::new();
        for (t, &[fan, ..]) in fans.of_triangles.iter().enumerate() {
            let next = parts.volumes.len() as u32;
            let part = *numbers.entry(roots.root(fan)).or_insert(next);
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

    /// Whether each part has a positive volume, and it is clear which they are.
    pub(super) fn face_outwards(&self) -> bool {
        self.are_clear && self.volumes.iter().all(|&volume| volume >= 0.0)
    }

    /// Whether parts that do not touch are each the boundary of the solid: with nothing around those
    /// that face outwards, and one solid around those that face a cavity.
    pub(super) fn are_nested(&self, mesh: &Mesh) -> bool {
        if self.volumes.len() == 1 {
            return self.face_outwards();
        }
        let lines = Lines::new(mesh);
        (0..).zip(&self.volumes).all(|(part, &volume)| {
            let largest = mesh.corners(self.largest[part as usize] as usize);
            let others = |t: u32| self.part_of[t as usize] != part;
            let around = lines.winding(middle(largest), others);
            around == i32::from(volume < 0.0)
        })
    }
}

/// Turns triangles until those with a common edge agree, most of each patch stays as it was, and no
/// patch is inside out; where one is turned, all within it are. Returns how many were turned.
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
    let inside_out = inside_out(mesh, &patches, triangles);
    for (triangle, &patch) in triangles.iter_mut().zip(&patches.patch_of) {
        if inside_out[patch as usize] {
            triangle.reverse();
        }
    }
    let pairs = triangles.iter().zip(&before);
    pairs.filter(|(now, before)| now != before).count()
}

/// Which patches are inside out, each taken for a body of its own with its holes closed. A patch
/// turns with the one around it, so a mirrored body keeps its cavities; it is inside out if it
/// has a negative volume then and no solid around it that it could be a cavity of.
fn inside_out(mesh: &Mesh, patches: &Patches, triangles: &[[u32; 3]]) -> Vec<bool> {
    let mut bodies = vec![Vec::new(); patches.count];
    for (triangle, &patch) in triangles.iter().zip(&patches.patch_of) {
        bodies[patch as usize].push(*triangle);
    }
    bodies.par_iter_mut().for_each(|body| {
        let (_, filling) = holes::fill(mesh.vertices(), body);
        body.extend(filling);
    });
    let corners = |t: &[u32; 3]| t.map(|v| mesh.vertices()[v as usize]);
    let (low, _) = mesh.bounds();
    let gap = gap(mesh);
    let volume = |body: &Vec<[u32; 3]>| -> f64 {
        let volume: f64 = body.iter().map(|t| signed_volume(corners(t), low)).sum();
        let area: f64 = body.iter().map(|t| area(corners(t))).sum();
        // What is no thicker than a gap has none.
        let is_flat = 2.0 * volume.abs() <= gap * area;
        if is_flat { 0.0 } else { volume }
    };
    let volumes: Vec<f64> = bodies.iter().map(volume).collect();
    if volumes.iter().all(|&volume| volume >= 0.0) {
        return vec![false; patches.count];
    }
    let owners = (0_u32..).zip(&bodies);
    let owners: Vec<u32> = owners.flat_map(|(p, b)| b.iter().map(move |_| p)).collect();
    let lines = Lines::of(Cow::Owned(mesh.with_triangles(bodies.concat())));
    // Which others wind around each patch, and how often, for most of its area: a part of it may lie
    // on another.
    let around = |patch: usize| {
        let mut windings: FxHashMap<u32, f64> = FxHashMap::default();
        let mut all = 0.0;
        for triangle in bodies[patch].iter().map(corners) {
            let area = area(triangle);
            all += area;
            lines.for_each_crossing(middle(triangle), |t, change| {
                *windings.entry(owners[t as usize]).or_default() += area * f64::from(change);
            });
        }
        let windings = windings.into_iter();
        let windings = windings.map(|(other, sum)| (other, (sum / all).round() as i32));
        let mut around: Vec<(u32, i32)> = windings
            .filter(|&(other, winding)| other != patch as u32 && winding != 0)
            .collect();
        around.sort_unstable();
        around
    };
    let around: Vec<_> = (0..patches.count).into_par_iter().map(around).collect();
    let mut from_outside: Vec<usize> = (0..patches.count).collect();
    from_outside.sort_by_key(|&patch| around[patch].len());
    let mut is_turned = vec![false; patches.count];
    for patch in from_outside {
        let outer = around[patch].iter().map(|&(outer, winding)| {
            let is_turned = is_turned[outer as usize];
            (outer as usize, if is_turned { -winding } else { winding })
        });
        let closest = outer.clone().max_by_key(|&(outer, _)| around[outer].len());
        let with_closest = closest.is_some_and(|(outer, _)| is_turned[outer]);
        let is_negative = if with_closest {
            volumes[patch] > 0.0
        } else {
            volumes[patch] < 0.0
        };
        let solid: i32 = outer.map(|(_, winding)| winding).sum();
        is_turned[patch] = with_closest != (is_negative && solid <= 0);
    }
    is_turned
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
