//! The solid that a mesh means, as a surface that faces outwards.
//!
//! A clean mesh stays as it is. Otherwise `repair` removes duplicate faces, orients neighbours
//! consistently, turns bodies that are inside out (`orientation`), and closes holes (`holes`). Winding
//! numbers (`winding`) are whole after that, and the solid is where they are one or more. Where parts
//! overlap or touch (`self_contact`), the surface is replaced by the boundary of the solid (`union`),
//! without faces inside. `bodies` and `fans` tell apart bodies that share vertices. A mesh with more
//! holes than faces stays open, and generalised winding numbers (`fast_winding`) decide.
//!
//! `voxelize` classifies voxels. `exact` measures depths without voxels.

mod bodies;
pub(crate) mod exact;
mod fans;
mod fast_winding;
mod holes;
mod orientation;
pub(crate) mod repair;
pub(crate) mod self_contact;
mod union;
pub(crate) mod voxelize;
mod winding;

use std::borrow::Cow;

use glamx::DVec3;
use rayon::prelude::*;
use rustc_hash::FxHashSet;
use vps_core::Grid;

use self::fast_winding::FastWinding;
use self::repair::{Repairs, surface};
use self::union::{Layout, UnionError, layout, union};
use self::voxelize::VoxelClasses;
use self::winding::ScanlineIndex;
use crate::error::BuildError;
use crate::mesh::Mesh;
use crate::mesh::faces::canonical_rotation;
use crate::mesh::sheet::encloses_sheet;
use crate::mesh::triangle::{middle, normal};
use crate::options::Sign;

/// A solid on a grid.
pub(crate) struct Solid<'m> {
    /// Its surface.
    pub(crate) mesh: Cow<'m, Mesh>,
    /// The class of each voxel.
    pub(crate) classes: VoxelClasses,
    /// Whether the mesh is closed without faces inside, so that sums over its faces are exact.
    pub(crate) is_closed: bool,
    pub(crate) repairs: Repairs,
}

/// Memory per triangle while the union of parts is computed, in bytes.
const BYTES_PER_MERGED: u64 = 2000;

/// The solid that the mesh means, on a grid.
///
/// # Errors
/// When it encloses nothing, or a union would take more than `memory_limit` bytes.
pub(crate) fn solid<'m>(
    mesh: &'m Mesh,
    sign: Sign,
    grid: &Grid,
    memory_limit: u64,
) -> Result<Solid<'m>, BuildError> {
    let mut repairs = Repairs::default();
    let surface = surface(mesh, sign, grid, &mut repairs)?;
    if repairs.left_open {
        return open_solid(surface, grid, repairs);
    }
    let closed = |mesh, classes, repairs| Solid {
        mesh,
        classes,
        is_closed: true,
        repairs,
    };
    let mut found = layout(&surface);
    if found == Layout::Simple {
        let (classes, is_simple) = VoxelClasses::by_winding(&surface, grid);
        if is_simple {
            return Ok(closed(surface, classes, repairs));
        }
        // Triangles that touch along lines may be parts that cross there.
        found = Layout::Overlapping;
    }
    let triangles = surface.triangles().len();
    let needed = triangles as u64 * BYTES_PER_MERGED;
    if needed > memory_limit {
        return Err(BuildError::UnionMemory {
            triangles,
            needed_mib: needed.div_ceil(1 << 20),
            limit_mib: memory_limit >> 20,
        });
    }
    match union(&surface, found) {
        Ok(boundary) if encloses_sheet(&boundary) => Err(BuildError::NotSolid),
        Ok(boundary) => {
            repairs.merged = true;
            let boundary = with_sheets(boundary, &surface, grid)?;
            let (classes, _) = VoxelClasses::by_winding(&boundary, grid);
            Ok(closed(Cow::Owned(boundary), classes, repairs))
        }
        Err(UnionError::Empty) => Err(BuildError::NotSolid),
        Err(UnionError::Failed) => {
            repairs.still_overlapping = true;
            let (classes, _) = VoxelClasses::by_winding(&surface, grid);
            let scanlines = ScanlineIndex::new(&surface);
            let in_solid = |p| scanlines.winding(p, |_| true) >= 1;
            remove_hidden_faces(&surface, classes, grid, in_solid, repairs)
        }
    }
}

/// The boundary of a solid with the sheets of zero thickness outside of it: faces of the surface that
/// coincident faces cancel. Each is added in both orientations, so that the surface stays closed.
fn with_sheets(boundary: Mesh, surface: &Mesh, grid: &Grid) -> Result<Mesh, BuildError> {
    let scanlines = ScanlineIndex::new(surface);
    let winding = |p| scanlines.winding(p, |_| true);
    let offset = FACE_OFFSET * f64::from(grid.voxel_size());
    let is_sheet = |&t: &usize| {
        let [in_front, behind] = sides(surface, t, offset).map(winding);
        in_front == behind && behind < 1
    };
    let count = surface.triangles().len();
    let sheets: Vec<usize> = (0..count).into_par_iter().filter(is_sheet).collect();
    if sheets.is_empty() {
        return Ok(boundary);
    }
    let first = boundary.vertices().len() as u32;
    let vertices = [boundary.vertices(), surface.vertices()].concat();
    let mut seen = FxHashSet::default();
    let mut triangles = boundary.triangles().to_vec();
    for t in sheets {
        let [a, b, c] = surface.triangles()[t].map(|v| v + first);
        for side in [[a, b, c], [a, c, b]] {
            if seen.insert(canonical_rotation(side)) {
                triangles.push(side);
            }
        }
    }
    Ok(Mesh::new(&vertices, &triangles)?)
}

/// Points in front of and behind a face.
fn sides(mesh: &Mesh, face: usize, offset: f64) -> [DVec3; 2] {
    let corners = mesh.corners(face);
    let (middle, step) = (middle(corners), normal(corners) * offset);
    [middle + step, middle - step]
}

impl<'m> Solid<'m> {
    /// The same solid on another grid.
    pub(crate) fn on(
        self,
        mesh: &'m Mesh,
        sign: Sign,
        grid: &Grid,
        memory_limit: u64,
    ) -> Result<Self, BuildError> {
        if !self.is_closed {
            return solid(mesh, sign, grid, memory_limit);
        }
        let (classes, _) = VoxelClasses::by_winding(&self.mesh, grid);
        Ok(Self { classes, ..self })
    }
}

/// The solid of a mesh with open holes, by generalised winding numbers.
fn open_solid<'m>(
    surface: Cow<'m, Mesh>,
    grid: &Grid,
    repairs: Repairs,
) -> Result<Solid<'m>, BuildError> {
    let fast_winding = FastWinding::new(&surface);
    let winding = |p| fast_winding.winding(p);
    let (classes, is_simple) = VoxelClasses::by_generalized_winding(&surface, grid, winding);
    if !classes.has_interior() {
        return Err(BuildError::NotSolid);
    }
    if !is_simple {
        return remove_hidden_faces(&surface, classes, grid, |p| winding(p) > 0.5, repairs);
    }
    drop(fast_winding);
    Ok(Solid {
        mesh: surface,
        classes,
        is_closed: false,
        repairs,
    })
}

/// The solid without the faces that lie entirely within it.
fn remove_hidden_faces<'m>(
    surface: &Mesh,
    classes: VoxelClasses,
    grid: &Grid,
    in_solid: impl Fn(DVec3) -> bool + Sync,
    mut repairs: Repairs,
) -> Result<Solid<'m>, BuildError> {
    let boundary = boundary_faces(surface, grid, in_solid);
    repairs.hidden_faces += surface.triangles().len() - boundary.len();
    if boundary.is_empty() {
        return Err(BuildError::NotSolid);
    }
    let mesh = Mesh::new(surface.vertices(), &boundary)?;
    Ok(Solid {
        // Voxels of hidden faces are not surface voxels.
        classes: classes.with_surface(&mesh),
        mesh: Cow::Owned(mesh),
        is_closed: false,
        repairs,
    })
}

/// Distance in voxels from a face at which winding numbers are evaluated.
const FACE_OFFSET: f64 = 1e-4;

/// The faces with solid behind them and none in front.
fn boundary_faces(
    mesh: &Mesh,
    grid: &Grid,
    in_solid: impl Fn(DVec3) -> bool + Sync,
) -> Vec<[u32; 3]> {
    let offset = FACE_OFFSET * f64::from(grid.voxel_size());
    let is_boundary = |&t: &usize| {
        let [in_front, behind] = sides(mesh, t, offset);
        in_solid(behind) && !in_solid(in_front)
    };
    let all = mesh.triangles();
    let boundary = (0..all.len()).into_par_iter().filter(is_boundary);
    boundary.map(|t| all[t]).collect()
}
