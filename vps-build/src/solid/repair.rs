//! A closed surface that faces outwards, from any mesh.

use std::borrow::Cow;

use rustc_hash::FxHashSet;
use vps_core::Grid;

use super::bodies::Bodies;
use super::holes;
use super::orientation::{orient_by_fill, orient_by_neighbours};
use crate::error::BuildError;
use crate::mesh::Mesh;
use crate::mesh::edges::{Edge, Edges};
use crate::mesh::faces::{canonical_rotation, has_distinct_corners};
use crate::mesh::triangle;
use crate::options::Sign;

/// Repairs that made a solid of a mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Repairs {
    /// Duplicate faces, and faces with two corners at one position.
    pub removed_faces: usize,
    /// Faces turned around.
    pub turned_faces: usize,
    /// Closed holes.
    pub closed_holes: usize,
    /// Faces that close holes.
    pub added_faces: usize,
    /// Faces removed as they were inside the solid.
    pub hidden_faces: usize,
    /// Whether parts overlapped or touched and were replaced by the boundary of their union.
    pub merged: bool,
    /// Whether parts still overlap because their union failed. Depths near faces within the solid
    /// are then too small.
    pub still_overlapping: bool,
    /// Whether holes were left open, and generalised winding numbers decided on inside and outside.
    pub left_open: bool,
}

impl Repairs {
    /// Whether the mesh needed no repair.
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }
}

/// The triangles of the mesh, each once and facing outwards. Holes are closed unless
/// `repairs.left_open` is set.
pub(crate) fn surface<'m>(
    mesh: &'m Mesh,
    sign: Sign,
    grid: &Grid,
    repairs: &mut Repairs,
) -> Result<Cow<'m, Mesh>, BuildError> {
    if sign != Sign::Fill
        && let Some(surface) = outward_bodies(mesh, sign, repairs)?
    {
        return Ok(surface);
    }
    let mut triangles = unique_unoriented(mesh);
    repairs.removed_faces = mesh.triangles().len() - triangles.len();
    if triangles.is_empty() {
        return Err(BuildError::NotSolid);
    }
    if sign == Sign::Fill {
        let before = triangles.len();
        let kept = mesh.with_triangles(triangles.clone());
        repairs.turned_faces = orient_by_fill(&kept, grid, &mut triangles);
        repairs.hidden_faces = before - triangles.len();
        if triangles.is_empty() {
            return Err(BuildError::NotSolid);
        }
    } else {
        let kept = mesh.with_triangles(triangles.clone());
        repairs.turned_faces = orient_by_neighbours(&kept, &mut triangles);
    }
    let closing = HoleFilling::of(mesh, &triangles, sign);
    repairs.left_open = closing.is_too_large;
    if !closing.is_too_large {
        repairs.closed_holes = closing.holes;
        repairs.added_faces = closing.filling.len();
        triangles.extend(closing.filling);
    }
    Ok(Cow::Owned(Mesh::new(mesh.vertices(), &triangles)?))
}

/// The surface of bodies that face outwards, if the mesh is one; bodies may have holes. A face
/// shared by two bodies is there in both orientations.
fn outward_bodies<'m>(
    mesh: &'m Mesh,
    sign: Sign,
    repairs: &mut Repairs,
) -> Result<Option<Cow<'m, Mesh>>, BuildError> {
    let mut triangles = unique_oriented(mesh);
    let removed = mesh.triangles().len() - triangles.len();
    let edges = Edges::of(&triangles);
    let disagree = |uses: &[Edge]| matches!(uses, [a, b] if a.forward == b.forward);
    if triangles.is_empty() || edges.groups().any(disagree) {
        return Ok(None);
    }
    let closing = if edges.open_count() > 0 {
        HoleFilling::of(mesh, &triangles, sign)
    } else {
        HoleFilling::default()
    };
    let surface = if removed == 0 && closing.filling.is_empty() {
        Cow::Borrowed(mesh)
    } else {
        triangles.extend_from_slice(&closing.filling);
        Cow::Owned(Mesh::new(mesh.vertices(), &triangles)?)
    };
    if closing.is_too_large || !Bodies::of(&surface).face_outwards() {
        return Ok(None);
    }
    repairs.removed_faces = removed;
    repairs.closed_holes = closing.holes;
    repairs.added_faces = closing.filling.len();
    Ok(Some(surface))
}

/// Faces that close the holes of a surface.
#[derive(Default)]
struct HoleFilling {
    holes: usize,
    filling: Vec<[u32; 3]>,
    /// Whether the holes stay open instead.
    is_too_large: bool,
}

impl HoleFilling {
    fn of(mesh: &Mesh, triangles: &[[u32; 3]], sign: Sign) -> Self {
        let (holes, filling) = holes::fill(mesh.vertices(), triangles);
        let area = |triangles: &[[u32; 3]]| -> f64 {
            let corners = |t: &[u32; 3]| t.map(|v| mesh.vertices()[v as usize]);
            triangles.iter().map(corners).map(triangle::area).sum()
        };
        let is_too_large = match sign {
            Sign::Winding => false,
            Sign::Generalized => !filling.is_empty(),
            Sign::Auto | Sign::Fill => area(&filling) > MAX_FILLED_AREA * area(triangles),
        };
        Self {
            holes,
            filling,
            is_too_large,
        }
    }
}

/// Area of the filling, relative to the mesh, beyond which the holes stay open.
const MAX_FILLED_AREA: f64 = 0.5;

/// Triangles with distinct corners, without duplicates of the same orientation.
fn unique_oriented(mesh: &Mesh) -> Vec<[u32; 3]> {
    let mut seen = FxHashSet::default();
    let mut is_new =
        |t: &&[u32; 3]| has_distinct_corners(t) && seen.insert(canonical_rotation(**t));
    mesh.triangles()
        .iter()
        .filter(&mut is_new)
        .copied()
        .collect()
}

/// Triangles with distinct corners, without duplicates of either orientation.
fn unique_unoriented(mesh: &Mesh) -> Vec<[u32; 3]> {
    let mut seen = FxHashSet::default();
    let mut is_new = |triangle: &&[u32; 3]| {
        let mut corners = **triangle;
        corners.sort_unstable();
        has_distinct_corners(triangle) && seen.insert(corners)
    };
    mesh.triangles()
        .iter()
        .filter(&mut is_new)
        .copied()
        .collect()
}
