//! The solid that a mesh means, as a surface that faces outwards.
//!
//! A clean mesh stays as it is. Otherwise faces that are there twice are taken out, neighbours are
//! turned the same way, parts that are inside out are turned, and holes are closed by fans. After
//! that every point has a whole winding number, and the solid is where it is one or more; faces
//! within the solid, where parts overlap, are taken out. A mesh that consists of holes more than
//! of faces is left open, and its generalised winding numbers decide.

use std::borrow::Cow;

use glamx::DVec3;
use rayon::prelude::*;
use rustc_hash::{FxHashMap, FxHashSet};
use vps_core::Grid;

use crate::edges::Edges;
use crate::health::UnionFind;
use crate::places::{Place, Places};
use crate::solid_angle::SolidAngle;
use crate::triangle::signed_volume;
use crate::winding::Lines;
use crate::{BuildError, Mesh};

/// Which side of a triangle is the inside.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sign {
    /// As [`Winding`](Self::Winding), or as [`Generalized`](Self::Generalized) if what closes the
    /// holes would have more than half of the area of the mesh.
    #[default]
    Auto,
    /// The one it turns away from, once neighbours agree and holes are closed: by winding numbers.
    /// Cavities stay hollow if their walls face them.
    Winding,
    /// Where the generalised winding number is above one half; holes and cracks stay open.
    Generalized,
    /// The one that cannot be reached from outside through voxels free of triangles: for meshes
    /// whose faces are turned at random. Cavities are filled; holes must be smaller than a voxel.
    Fill,
}

/// What was done to a mesh to make a solid of it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Repairs {
    /// Faces that were there before, or have two corners in one place.
    pub removed_faces: usize,
    /// Faces turned around.
    pub turned_faces: usize,
    /// Holes that were closed.
    pub closed_holes: usize,
    /// Faces that close them.
    pub added_faces: usize,
    /// Faces within the solid, taken out.
    pub hidden_faces: usize,
    /// Whether holes were left open, and generalised winding numbers told what is inside.
    pub left_open: bool,
}

impl Repairs {
    /// Whether the mesh was a solid as it stood.
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }
}

/// A solid.
pub(crate) struct Solid<'m> {
    /// Its surface.
    pub(crate) mesh: Cow<'m, Mesh>,
    /// Where its voxels are.
    pub(crate) places: Places,
    /// Whether the mesh is closed and nowhere within itself, so that sums over its faces are exact.
    pub(crate) is_closed: bool,
    pub(crate) repairs: Repairs,
}

/// The solid that the mesh means, on a grid.
pub(crate) fn solid<'m>(mesh: &'m Mesh, sign: Sign, grid: &Grid) -> Result<Solid<'m>, BuildError> {
    let mut repairs = Repairs::default();
    let surface = surface(mesh, sign, grid, &mut repairs)?;
    let (places, is_simple, shown) = if repairs.left_open {
        let angle = SolidAngle::new(&surface);
        let winding = |p| angle.winding(p);
        let (places, is_simple) = Places::by_generalized_winding(&surface, grid, winding);
        let shown = || shown_faces(&surface, grid, |p| winding(p) > 0.5);
        (places, is_simple, (!is_simple).then(shown))
    } else {
        let (places, is_simple) = Places::by_winding(&surface, grid);
        let shown = || {
            let lines = Lines::new(&surface);
            shown_faces(&surface, grid, |p| lines.winding(p, |_| true) >= 1)
        };
        (places, is_simple, (!is_simple).then(shown))
    };
    let is_closed = is_simple && !repairs.left_open;
    if !is_closed && places.is_empty() {
        return Err(BuildError::NotSolid);
    }
    let Some(shown) = shown else {
        return Ok(Solid {
            mesh: surface,
            places,
            is_closed,
            repairs,
        });
    };
    repairs.hidden_faces += surface.triangles().len() - shown.len();
    if shown.is_empty() {
        return Err(BuildError::NotSolid);
    }
    let mesh = Mesh::new(surface.vertices(), &shown)?;
    Ok(Solid {
        // The places of hidden faces are no surface.
        places: places.with_surface(&mesh),
        mesh: Cow::Owned(mesh),
        is_closed,
        repairs,
    })
}

/// The triangles of the mesh, each once and facing outwards, without holes unless they are left
/// open.
pub(crate) fn surface<'m>(
    mesh: &'m Mesh,
    sign: Sign,
    grid: &Grid,
    repairs: &mut Repairs,
) -> Result<Cow<'m, Mesh>, BuildError> {
    let mut triangles = without_doubles(mesh);
    repairs.removed_faces = mesh.triangles().len() - triangles.len();
    if triangles.is_empty() {
        return Err(BuildError::NotSolid);
    }
    if sign == Sign::Fill {
        let before = triangles.len();
        let kept = Mesh::new(mesh.vertices(), &triangles)?;
        repairs.turned_faces = turn_by_fill(&kept, grid, &mut triangles);
        repairs.hidden_faces = before - triangles.len();
        if triangles.is_empty() {
            return Err(BuildError::NotSolid);
        }
    } else if repairs.removed_faces == 0
        && Edges::of(&triangles).open_count() == 0
        && all_parts_outwards(mesh)
    {
        return Ok(Cow::Borrowed(mesh));
    } else {
        let kept = Mesh::new(mesh.vertices(), &triangles)?;
        repairs.turned_faces = turn_by_neighbours(&kept, &mut triangles);
    }
    let mut vertices = mesh.vertices().to_vec();
    let (holes, fans) = fans(&mut vertices, &triangles);
    let area = |triangles: &[[u32; 3]]| -> f64 {
        let corners = |t: &[u32; 3]| t.map(|v| vertices[v as usize]);
        let double = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a).length();
        triangles.iter().map(corners).map(double).sum()
    };
    repairs.left_open = match sign {
        Sign::Winding => false,
        Sign::Generalized => !fans.is_empty(),
        Sign::Auto | Sign::Fill => area(&fans) > MOST_CLOSED * area(&triangles),
    };
    if !repairs.left_open {
        repairs.closed_holes = holes;
        repairs.added_faces = fans.len();
        triangles.extend(fans);
    }
    Ok(Cow::Owned(Mesh::new(&vertices, &triangles)?))
}

/// Above what share of its area the fans that close a mesh mean that it has no holes but cracks.
const MOST_CLOSED: f64 = 0.5;

/// All triangles with three corners, each once, whichever way it turns.
fn without_doubles(mesh: &Mesh) -> Vec<[u32; 3]> {
    let mut seen = FxHashSet::default();
    let mut is_new = |triangle: &&[u32; 3]| {
        let mut corners = **triangle;
        corners.sort_unstable();
        corners[0] != corners[1] && corners[1] != corners[2] && seen.insert(corners)
    };
    mesh.triangles()
        .iter()
        .filter(&mut is_new)
        .copied()
        .collect()
}

/// Whether each part of a closed mesh has a positive volume.
fn all_parts_outwards(mesh: &Mesh) -> bool {
    let mut parts = UnionFind::new(mesh.vertices().len());
    for &[a, b, c] in mesh.triangles() {
        parts.join(a, b);
        parts.join(b, c);
    }
    let (origin, _) = mesh.bounds();
    let mut volumes = FxHashMap::default();
    for (t, &[vertex, ..]) in mesh.triangles().iter().enumerate() {
        *volumes.entry(parts.root(vertex)).or_insert(0.0) += signed_volume(mesh.corners(t), origin);
    }
    volumes.values().all(|&volume| volume >= 0.0)
}

/// Turns triangles until those with a common edge agree, most of each patch stays as it was, and
/// no patch is inside out unless it lies within another one. Returns how many were turned.
fn turn_by_neighbours(mesh: &Mesh, triangles: &mut [[u32; 3]]) -> usize {
    let before = triangles.to_vec();
    let edges = Edges::of(triangles);
    let patches = Patches::of(triangles.len(), &edges);
    let area = |t: usize| {
        let [a, b, c] = mesh.corners(t);
        (b - a).cross(c - a).length()
    };
    // Positive: the area that would stay as it is.
    let mut majority = vec![0.0; patches.count];
    for (t, &patch) in patches.patch_of.iter().enumerate() {
        majority[patch as usize] += if patches.turned[t] { -area(t) } else { area(t) };
    }
    for (t, &patch) in patches.patch_of.iter().enumerate() {
        if patches.turned[t] == (majority[patch as usize] >= 0.0) {
            triangles[t].reverse();
        }
    }
    // The volume of a patch, closed from the middle of its rim.
    let mut rims = vec![(DVec3::ZERO, 0.0); patches.count];
    for uses in edges.groups().filter(|uses| uses.len() != 2) {
        for edge in uses {
            let corners = before[edge.triangle as usize];
            let ends = corners.iter().position(|&v| v == edge.between.0);
            let ends = ends.zip(corners.iter().position(|&v| v == edge.between.1));
            let (from, to) = ends.expect("an edge lies between corners");
            let at = mesh.corners(edge.triangle as usize);
            let length = at[from].distance(at[to]);
            let rim = &mut rims[patches.patch_of[edge.triangle as usize] as usize];
            rim.0 += at[from].midpoint(at[to]) * length;
            rim.1 += length;
        }
    }
    let (low, _) = mesh.bounds();
    let mut volumes = vec![0.0; patches.count];
    for (t, &patch) in patches.patch_of.iter().enumerate() {
        let (sum, length) = rims[patch as usize];
        let middle = if length > 0.0 { sum / length } else { low };
        let volume = signed_volume(mesh.corners(t), middle);
        volumes[patch as usize] += if triangles[t] == before[t] {
            volume
        } else {
            -volume
        };
    }
    if volumes.iter().any(|&volume| volume < 0.0) {
        let lines = Lines::new(mesh);
        let mut inside_out = vec![None; patches.count];
        for (t, &patch) in patches.patch_of.iter().enumerate() {
            if volumes[patch as usize] < 0.0 {
                let turn = inside_out[patch as usize].get_or_insert_with(|| {
                    let others = |o: u32| patches.patch_of[o as usize] != patch;
                    lines.winding(mesh.corners(t)[0], others) == 0
                });
                if *turn {
                    triangles[t].reverse();
                }
            }
        }
    }
    let is_turned = |(a, b): (&[u32; 3], &[u32; 3])| usize::from(a != b);
    before.iter().zip(&*triangles).map(is_turned).sum()
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

/// How far from a triangle, in voxels, its sides are looked for.
const SIDE_REACH: u32 = 3;

/// Turns triangles so that what can be reached from outside is in front of them, and takes out
/// those that cannot be reached. Returns how many were turned.
fn turn_by_fill(mesh: &Mesh, grid: &Grid, triangles: &mut Vec<[u32; 3]>) -> usize {
    let places = Places::by_fill(mesh, grid);
    let step = 0.5 * f64::from(grid.voxel_size());
    let mut turned = 0;
    let mut t = 0;
    triangles.retain_mut(|triangle| {
        let [a, b, c] = mesh.corners(t);
        t += 1;
        let middle = (a + b + c) / 3.0;
        let normal = (b - a).cross(c - a).normalize_or_zero();
        let is_outside = |direction: DVec3| {
            let steps = 1..=2 * SIDE_REACH;
            let mut ahead =
                steps.map(|i| places.of_point(middle + direction * (step * f64::from(i))));
            ahead.find(|&place| place != Place::Surface) == Some(Place::Outside)
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

/// Fans that close all holes: from the middle of each rim, whose vertex is added, to its edges.
/// Returns how many holes there are, too.
fn fans(vertices: &mut Vec<DVec3>, triangles: &[[u32; 3]]) -> (usize, Vec<[u32; 3]>) {
    let mut rims = UnionFind::new(vertices.len());
    let mut open = Vec::new();
    for uses in Edges::of(triangles).groups() {
        let excess = Edges::excess(uses);
        if excess != 0 {
            let (low, high) = uses[0].between;
            rims.join(low, high);
            let (from, to) = if excess > 0 { (low, high) } else { (high, low) };
            open.push((from, to, excess.unsigned_abs()));
        }
    }
    // The rims in the order of their first edges.
    let mut middles: FxHashMap<u32, usize> = FxHashMap::default();
    let mut sums: Vec<(DVec3, f64)> = Vec::new();
    for &(from, to, _) in &open {
        let rim = *middles.entry(rims.root(from)).or_insert_with(|| {
            sums.push((DVec3::ZERO, 0.0));
            sums.len() - 1
        });
        let [a, b] = [from, to].map(|v| vertices[v as usize]);
        let length = a.distance(b);
        sums[rim].0 += a.midpoint(b) * length;
        sums[rim].1 += length;
    }
    let first = vertices.len();
    vertices.extend(sums.iter().map(|(sum, length)| *sum / *length));
    let mut fans = Vec::new();
    for (from, to, times) in open {
        let middle = (first + middles[&rims.root(from)]) as u32;
        fans.extend((0..times).map(|_| [to, from, middle]));
    }
    (sums.len(), fans)
}

/// How far in front of and behind a face, in voxels, winding numbers are taken.
const FACE_OFFSET: f64 = 1e-4;

/// The faces between the solid and the rest.
fn shown_faces(mesh: &Mesh, grid: &Grid, in_solid: impl Fn(DVec3) -> bool + Sync) -> Vec<[u32; 3]> {
    let offset = FACE_OFFSET * f64::from(grid.voxel_size());
    let is_shown = |&t: &usize| {
        let [a, b, c] = mesh.corners(t);
        let middle = (a + b + c) / 3.0;
        let normal = (b - a).cross(c - a).normalize_or_zero() * offset;
        in_solid(middle - normal) && !in_solid(middle + normal)
    };
    let all = mesh.triangles();
    let shown = (0..all.len()).into_par_iter().filter(is_shown);
    shown.map(|t| all[t]).collect()
}
