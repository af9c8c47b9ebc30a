//! The solid that a mesh means, as a surface that faces outwards.
//!
//! A clean mesh stays as it is. Otherwise faces that are there twice are taken out, neighbours are
//! turned the same way, parts that are inside out are turned, and holes are closed (`orientation`,
//! `holes`). After that every point has a whole winding number, and the solid is where it is one or
//! more. Where parts overlap or touch (`self_contact`), the surface is replaced by the boundary of
//! that solid (`union`), so that no face lies within it. A mesh that consists of holes more than of
//! faces is left open, and its generalised winding numbers decide.

mod box_tree;
mod fans;
mod holes;
mod orientation;
pub(crate) mod self_contact;
mod union;

use std::borrow::Cow;

use glamx::DVec3;
use rayon::prelude::*;
use rustc_hash::FxHashSet;
use vps_core::Grid;

use self::orientation::{Parts, turn_by_neighbours};
use self::union::{Layout, NoUnion, layout, union};
use crate::edges::{Edge, Edges};
use crate::flat::bounds_a_sheet;
use crate::places::{Place, Places};
use crate::solid_angle::SolidAngle;
use crate::triangle::{self, middle, normal};
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
    /// Faces within the solid, taken out as they are.
    pub hidden_faces: usize,
    /// Whether parts overlapped or touched, and the boundary of their union was taken.
    pub united: bool,
    /// Whether parts overlap still, as their union could not be found: depths near faces within the
    /// solid are too small.
    pub left_overlapping: bool,
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

/// Bytes a triangle takes while the union of parts is found.
const BYTES_PER_UNITED: u64 = 2000;

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
    let closed = |mesh, places, repairs| Solid {
        mesh,
        places,
        is_closed: true,
        repairs,
    };
    let mut found = layout(&surface);
    if found == Layout::Simple {
        let (places, is_simple) = Places::by_winding(&surface, grid);
        if is_simple {
            return Ok(closed(surface, places, repairs));
        }
        // Triangles that touch along lines may be parts that cross there.
        found = Layout::Overlapping;
    }
    let triangles = surface.triangles().len();
    let needed = triangles as u64 * BYTES_PER_UNITED;
    if needed > memory_limit {
        return Err(BuildError::UnionMemory {
            triangles,
            needed_mib: needed.div_ceil(1 << 20),
            limit_mib: memory_limit >> 20,
        });
    }
    match union(&surface, found) {
        Ok(boundary) if bounds_a_sheet(&boundary) => Err(BuildError::NotSolid),
        Ok(boundary) => {
            repairs.united = true;
            let boundary = with_sheets(boundary, &surface, grid)?;
            let (places, _) = Places::by_winding(&boundary, grid);
            Ok(closed(Cow::Owned(boundary), places, repairs))
        }
        Err(NoUnion::Empty) => Err(BuildError::NotSolid),
        Err(NoUnion::Failed) => {
            repairs.left_overlapping = true;
            let (places, _) = Places::by_winding(&surface, grid);
            let lines = Lines::new(&surface);
            let in_solid = |p| lines.winding(p, |_| true) >= 1;
            without_hidden(&surface, places, grid, in_solid, repairs)
        }
    }
}

/// The boundary of a solid and the sheets without thickness outside of it: faces of the surface that
/// a face on the same place cancels. Both of their sides count, so that the surface stays closed.
fn with_sheets(boundary: Mesh, surface: &Mesh, grid: &Grid) -> Result<Mesh, BuildError> {
    let lines = Lines::new(surface);
    let winding = |p| lines.winding(p, |_| true);
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
            if seen.insert(from_least(side)) {
                triangles.push(side);
            }
        }
    }
    Ok(Mesh::new(&vertices, &triangles)?)
}

/// Points in front of and behind a face.
fn sides(mesh: &Mesh, face: usize, offset: f64) -> [DVec3; 2] {
    let corners = mesh.corners(face);
    let (middle, way) = (middle(corners), normal(corners) * offset);
    [middle + way, middle - way]
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
        let (places, _) = Places::by_winding(&self.mesh, grid);
        Ok(Self { places, ..self })
    }
}

/// The solid of a mesh whose holes stay open, by its generalised winding numbers.
fn open_solid<'m>(
    surface: Cow<'m, Mesh>,
    grid: &Grid,
    repairs: Repairs,
) -> Result<Solid<'m>, BuildError> {
    let angle = SolidAngle::new(&surface);
    let winding = |p| angle.winding(p);
    let (places, is_simple) = Places::by_generalized_winding(&surface, grid, winding);
    if !places.have_interior() {
        return Err(BuildError::NotSolid);
    }
    if !is_simple {
        return without_hidden(&surface, places, grid, |p| winding(p) > 0.5, repairs);
    }
    drop(angle);
    Ok(Solid {
        mesh: surface,
        places,
        is_closed: false,
        repairs,
    })
}

/// The solid without the faces that lie within it as a whole.
fn without_hidden<'m>(
    surface: &Mesh,
    places: Places,
    grid: &Grid,
    in_solid: impl Fn(DVec3) -> bool + Sync,
    mut repairs: Repairs,
) -> Result<Solid<'m>, BuildError> {
    let shown = shown_faces(surface, grid, in_solid);
    repairs.hidden_faces += surface.triangles().len() - shown.len();
    if shown.is_empty() {
        return Err(BuildError::NotSolid);
    }
    let mesh = Mesh::new(surface.vertices(), &shown)?;
    Ok(Solid {
        // The places of hidden faces are no surface.
        places: places.with_surface(&mesh),
        mesh: Cow::Owned(mesh),
        is_closed: false,
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
    if sign != Sign::Fill
        && let Some(surface) = outward_bodies(mesh, sign, repairs)?
    {
        return Ok(surface);
    }
    let mut triangles = without_doubles(mesh);
    repairs.removed_faces = mesh.triangles().len() - triangles.len();
    if triangles.is_empty() {
        return Err(BuildError::NotSolid);
    }
    if sign == Sign::Fill {
        let before = triangles.len();
        let kept = mesh.with_triangles(triangles.clone());
        repairs.turned_faces = turn_by_fill(&kept, grid, &mut triangles);
        repairs.hidden_faces = before - triangles.len();
        if triangles.is_empty() {
            return Err(BuildError::NotSolid);
        }
    } else {
        let kept = mesh.with_triangles(triangles.clone());
        repairs.turned_faces = turn_by_neighbours(&kept, &mut triangles);
    }
    let closing = Closing::of(mesh, &triangles, sign);
    repairs.left_open = closing.is_too_large;
    if !closing.is_too_large {
        repairs.closed_holes = closing.holes;
        repairs.added_faces = closing.filling.len();
        triangles.extend(closing.filling);
    }
    Ok(Cow::Owned(Mesh::new(mesh.vertices(), &triangles)?))
}

/// The surface of bodies that face outwards and may have holes, if that is what the mesh is: faces that
/// two of them share are there both ways.
fn outward_bodies<'m>(
    mesh: &'m Mesh,
    sign: Sign,
    repairs: &mut Repairs,
) -> Result<Option<Cow<'m, Mesh>>, BuildError> {
    let mut triangles = once_each_way(mesh);
    let removed = mesh.triangles().len() - triangles.len();
    let edges = Edges::of(&triangles);
    let disagree = |uses: &[Edge]| matches!(uses, [a, b] if a.forward == b.forward);
    if triangles.is_empty() || edges.groups().any(disagree) {
        return Ok(None);
    }
    let closing = if edges.open_count() > 0 {
        Closing::of(mesh, &triangles, sign)
    } else {
        Closing::default()
    };
    let surface = if removed == 0 && closing.filling.is_empty() {
        Cow::Borrowed(mesh)
    } else {
        triangles.extend_from_slice(&closing.filling);
        Cow::Owned(Mesh::new(mesh.vertices(), &triangles)?)
    };
    if closing.is_too_large || !Parts::of(&surface).face_outwards() {
        return Ok(None);
    }
    repairs.removed_faces = removed;
    repairs.closed_holes = closing.holes;
    repairs.added_faces = closing.filling.len();
    Ok(Some(surface))
}

/// What closes the holes of a surface.
#[derive(Default)]
struct Closing {
    holes: usize,
    filling: Vec<[u32; 3]>,
    /// Whether the holes stay open instead.
    is_too_large: bool,
}

impl Closing {
    fn of(mesh: &Mesh, triangles: &[[u32; 3]], sign: Sign) -> Self {
        let (holes, filling) = holes::fill(mesh.vertices(), triangles);
        let area = |triangles: &[[u32; 3]]| -> f64 {
            let corners = |t: &[u32; 3]| t.map(|v| mesh.vertices()[v as usize]);
            triangles.iter().map(corners).map(triangle::area).sum()
        };
        let is_too_large = match sign {
            Sign::Winding => false,
            Sign::Generalized => !filling.is_empty(),
            Sign::Auto | Sign::Fill => area(&filling) > MOST_CLOSED * area(triangles),
        };
        Self {
            holes,
            filling,
            is_too_large,
        }
    }
}

/// Above what share of its area the faces that close a mesh mean that it has no holes but cracks.
const MOST_CLOSED: f64 = 0.5;

/// Whether no two corners of a triangle are one.
fn has_three_corners(&[a, b, c]: &[u32; 3]) -> bool {
    a != b && b != c && c != a
}

/// The triangle, turning the same way, from its least corner on: the same whichever came first.
fn from_least([a, b, c]: [u32; 3]) -> [u32; 3] {
    [[a, b, c], [b, c, a], [c, a, b]]
        .into_iter()
        .fold([a, b, c], Ord::min)
}

/// All triangles with three corners, each once each way it turns. Where bodies share a face it is
/// there both ways.
fn once_each_way(mesh: &Mesh) -> Vec<[u32; 3]> {
    let mut seen = FxHashSet::default();
    let mut is_new = |t: &&[u32; 3]| has_three_corners(t) && seen.insert(from_least(**t));
    mesh.triangles()
        .iter()
        .filter(&mut is_new)
        .copied()
        .collect()
}

/// All triangles with three corners, each once, whichever way it turns.
fn without_doubles(mesh: &Mesh) -> Vec<[u32; 3]> {
    let mut seen = FxHashSet::default();
    let mut is_new = |triangle: &&[u32; 3]| {
        let mut corners = **triangle;
        corners.sort_unstable();
        has_three_corners(triangle) && seen.insert(corners)
    };
    mesh.triangles()
        .iter()
        .filter(&mut is_new)
        .copied()
        .collect()
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
        let corners = mesh.corners(t);
        t += 1;
        let (middle, normal) = (middle(corners), normal(corners));
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

/// How far in front of and behind a face, in voxels, winding numbers are taken.
const FACE_OFFSET: f64 = 1e-4;

/// The faces between the solid and the rest.
fn shown_faces(mesh: &Mesh, grid: &Grid, in_solid: impl Fn(DVec3) -> bool + Sync) -> Vec<[u32; 3]> {
    let offset = FACE_OFFSET * f64::from(grid.voxel_size());
    let is_shown = |&t: &usize| {
        let [in_front, behind] = sides(mesh, t, offset);
        in_solid(behind) && !in_solid(in_front)
    };
    let all = mesh.triangles();
    let shown = (0..all.len()).into_par_iter().filter(is_shown);
    shown.map(|t| all[t]).collect()
}
