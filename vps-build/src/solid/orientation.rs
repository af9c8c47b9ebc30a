//! Consistent orientation of a surface: by neighbours, or by a fill from outside.

use std::borrow::Cow;

use glamx::DVec3;
use rayon::prelude::*;
use rustc_hash::FxHashMap;
use vps_core::Grid;

use super::holes;
use super::self_contact::gap_tolerance;
use super::voxelize::{VoxelClass, VoxelClasses};
use super::winding::ScanlineIndex;
use crate::mesh::Mesh;
use crate::mesh::edges::Edges;
use crate::mesh::triangle::{area, middle, normal, signed_volume};

/// Makes triangles with a common edge agree. Each patch keeps the orientation of most of its area.
/// A patch that is inside out is turned with all patches within it. Returns the number of turned
/// triangles.
pub(super) fn orient_by_neighbours(mesh: &Mesh, triangles: &mut [[u32; 3]]) -> usize {
    let before = triangles.to_vec();
    let edges = Edges::of(triangles);
    let patches = Patches::of(triangles.len(), &edges);
    // Area that keeps its orientation, less area that would turn.
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

/// Which patches are inside out. Each patch counts as a body, with its holes closed. It turns with
/// the patch around it, so a mirrored body keeps its cavities. It is inside out if its volume is
/// negative then and no solid around it makes it a cavity.
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
    let gap = gap_tolerance(mesh);
    let volume = |body: &Vec<[u32; 3]>| -> f64 {
        let volume: f64 = body.iter().map(|t| signed_volume(corners(t), low)).sum();
        let area: f64 = body.iter().map(|t| area(corners(t))).sum();
        // Thinner than a gap: no volume.
        let is_flat = 2.0 * volume.abs() <= gap * area;
        if is_flat { 0.0 } else { volume }
    };
    let volumes: Vec<f64> = bodies.iter().map(volume).collect();
    if volumes.iter().all(|&volume| volume >= 0.0) {
        return vec![false; patches.count];
    }
    let owners = (0_u32..).zip(&bodies);
    let owners: Vec<u32> = owners.flat_map(|(p, b)| b.iter().map(move |_| p)).collect();
    let scanlines = ScanlineIndex::of(Cow::Owned(mesh.with_triangles(bodies.concat())));
    // For each patch the other patches that wind around it, and how often. The mean over its area
    // is rounded, since a part of it may lie on another patch.
    let around = |patch: usize| {
        let mut windings: FxHashMap<u32, f64> = FxHashMap::default();
        let mut all = 0.0;
        for triangle in bodies[patch].iter().map(corners) {
            let area = area(triangle);
            all += area;
            scanlines.for_each_crossing(middle(triangle), |t, change| {
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

/// Components of triangles joined by edges with exactly two triangles.
struct Patches {
    count: usize,
    patch_of: Vec<u32>,
    /// Whether a triangle is oriented against the first of its patch.
    turned: Vec<bool>,
}

impl Patches {
    fn of(triangles: usize, edges: &Edges) -> Self {
        const NONE: u32 = u32::MAX;
        // The neighbours of each triangle, and whether they agree.
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

/// How far from a triangle, in voxels, to look for a voxel off the surface.
const SIDE_REACH: u32 = 3;

/// Orients triangles so that the outside is in front of them, and removes those that the outside
/// does not reach. Returns the number of turned triangles.
pub(super) fn orient_by_fill(mesh: &Mesh, grid: &Grid, triangles: &mut Vec<[u32; 3]>) -> usize {
    let classes = VoxelClasses::by_fill(mesh, grid);
    let step = 0.5 * f64::from(grid.voxel_size());
    let mut turned = 0;
    let mut t = 0;
    triangles.retain_mut(|triangle| {
        let corners = mesh.corners(t);
        t += 1;
        let (middle, normal) = (middle(corners), normal(corners));
        let is_outside = |direction: DVec3| {
            let steps = 1..=2 * SIDE_REACH;
            let mut ahead =
                steps.map(|i| classes.of_point(middle + direction * (step * f64::from(i))));
            ahead.find(|&class| class != VoxelClass::Surface) == Some(VoxelClass::Outside)
        };
        match (is_outside(normal), is_outside(-normal)) {
            (true, _) => true,
            (false, true) => {
                triangle.reverse();
                turned += 1;
                true
            }
            (false, false) => false,
        }
    });
    turned
}
