//! The boundary of the solid that a closed surface winds around at least once.
//!
//! Where parts of a surface overlap or touch, faces of theirs lie within the solid and are no
//! boundary. The surface is cut along all its intersections and what has solid on both sides is left
//! out (Zhou, Grinspun, Zorin and Jacobson 2016), by the crate `manifold-rust` in exact arithmetic.
//!
//! Parts that are a hair apart, as rounding leaves them, are joined as well: the surface is widened
//! by half of the widest gap, and the vertices of its union are put back on the faces they come from.

use std::panic::{AssertUnwindSafe, catch_unwind};

use glamx::{DMat3, DVec3};
use manifold_rust::manifold::Manifold;
use manifold_rust::types::{Error, MeshGL64, WindingRule};
use rayon::prelude::*;
use rustc_hash::FxHashSet;

use super::box_tree::BoxTree;
use super::fans::Fans;
use super::orientation::Parts;
use super::self_contact::{SelfContact, gap};
use super::{from_least, has_three_corners};
use crate::Mesh;
use crate::cells::Cells;
use crate::triangle::{area, closest_point, normal};

/// The most a corner moves, in widths of what its faces move, as miters of strokes are limited.
const MITER: f64 = 4.0;

/// How the parts of a surface lie to each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Layout {
    /// The surface is the boundary of its solid.
    Simple,
    /// Faces of it may lie within the solid.
    Overlapping,
    /// The same, and some face each other across a gap that is none.
    WithGaps,
}

/// How the parts of a closed surface lie to each other.
pub(super) fn layout(surface: &Mesh) -> Layout {
    let contact = SelfContact::of(surface, gap(surface));
    if contact.has_gaps {
        Layout::WithGaps
    } else if contact.meets || !Parts::of(surface).are_nested(surface) {
        Layout::Overlapping
    } else {
        Layout::Simple
    }
}

/// Why there is no boundary.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NoUnion {
    /// The surface winds around nothing.
    Empty,
    /// It could not be found.
    Failed,
}

/// The boundary of the solid that a closed surface winds around at least once.
pub(super) fn union(surface: &Mesh, layout: Layout) -> Result<Mesh, NoUnion> {
    let half_gap = 0.5 * gap(surface);
    if layout == Layout::WithGaps {
        let widened = widened(surface, half_gap)?;
        return put_back(&outer_boundary(&widened)?, &widened, surface, half_gap);
    }
    outer_boundary(surface)
}

fn outer_boundary(surface: &Mesh) -> Result<Mesh, NoUnion> {
    // Around the middle, so that coordinates have digits to spare.
    let (low, high) = surface.bounds();
    let middle = low.midpoint(high);
    let vertices = surface.vertices().iter();
    let input = MeshGL64 {
        num_prop: 3,
        vert_properties: vertices.flat_map(|v| (*v - middle).to_array()).collect(),
        tri_verts: surface
            .triangles()
            .iter()
            .flatten()
            .map(|&v| u64::from(v))
            .collect(),
        ..MeshGL64::default()
    };
    // Strangers' meshes must not end the program, whatever another's code makes of them.
    let output = catch_unwind(AssertUnwindSafe(|| {
        let solid = Manifold::from_mesh_gl64_robust(&input).rebuild_solid(WindingRule::Positive);
        (solid.status() == Error::NoError).then(|| solid.get_mesh_gl64(-1))
    }));
    let output = output.ok().flatten().ok_or(NoUnion::Failed)?;
    if output.tri_verts.is_empty() {
        return Err(NoUnion::Empty);
    }
    let stride = output.num_prop as usize;
    let vertices = output.vert_properties.chunks_exact(stride);
    let vertices: Vec<_> = vertices
        .map(|p| DVec3::new(p[0], p[1], p[2]) + middle)
        .collect();
    let triangles = output.tri_verts.chunks_exact(3);
    let triangles: Vec<_> = triangles
        .map(|t| [t[0], t[1], t[2]].map(|v| v as u32))
        .collect();
    let boundary = without_edges(&vertices, &triangles)?;
    if boundary.open_edges() > 0 {
        return Err(NoUnion::Failed);
    }
    Ok(boundary)
}

/// A mesh without those triangles of which two corners came to one place, or all to those of another
/// that turns the other way.
fn without_edges(vertices: &[DVec3], triangles: &[[u32; 3]]) -> Result<Mesh, NoUnion> {
    let new = |vertices: &[DVec3], triangles: &[[u32; 3]]| {
        Mesh::new(vertices, triangles).map_err(|_| NoUnion::Failed)
    };
    let mesh = new(vertices, triangles)?;
    let mut whole = mesh.triangles().to_vec();
    whole.retain(has_three_corners);
    let there: FxHashSet<_> = whole.iter().map(|&t| from_least(t)).collect();
    whole.retain(|&[a, b, c]| !there.contains(&from_least([a, c, b])));
    if whole.len() == mesh.triangles().len() {
        return Ok(mesh);
    }
    new(mesh.vertices(), &whole)
}

/// Planes a vertex is to be moved to.
#[derive(Clone, Copy)]
struct Planes {
    matrix: DMat3,
    side: DVec3,
    weight: f64,
}

impl Planes {
    const NONE: Self = Self {
        matrix: DMat3::ZERO,
        side: DVec3::ZERO,
        weight: 0.0,
    };

    /// A plane that lies `distance` metres along its unit normal.
    fn add(&mut self, normal: DVec3, distance: f64, weight: f64) {
        let columns = [normal.x, normal.y, normal.z].map(|c| normal * (c * weight));
        self.matrix += DMat3::from_cols(columns[0], columns[1], columns[2]);
        self.side += normal * (distance * weight);
        self.weight += weight;
    }

    /// The shortest way to all of them, or to where they are closest if they do not meet.
    fn way(&self) -> DVec3 {
        // Along directions of no plane nothing moves.
        let damped = self.matrix + DMat3::from_diagonal(DVec3::splat(DAMPING * self.weight));
        let way = damped.inverse() * self.side;
        if way.is_finite() { way } else { DVec3::ZERO }
    }
}

/// What a plane weighs beside all planes of a vertex to count.
const DAMPING: f64 = 1e-9;

/// The surface with each face moved outwards: each corner of a body goes where the planes of its
/// faces do.
fn widened(surface: &Mesh, by: f64) -> Result<Mesh, NoUnion> {
    let fans = Fans::of(surface, 2.0 * by);
    let mut planes = vec![Planes::NONE; fans.vertices.len()];
    for (t, corners) in fans.of_triangles.iter().enumerate() {
        let at = surface.corners(t);
        for &fan in corners {
            planes[fan as usize].add(normal(at), by, area(at));
        }
    }
    let vertices = fans.vertices.iter().zip(&planes);
    let moved = |(&v, planes): (&u32, &Planes)| {
        surface.vertices()[v as usize] + planes.way().clamp_length_max(MITER * by)
    };
    let vertices: Vec<_> = vertices.map(moved).collect();
    Mesh::new(&vertices, &fans.of_triangles).map_err(|_| NoUnion::Failed)
}

/// A boundary made of faces of a widened surface, its vertices back on the planes of the same faces of
/// the surface.
fn put_back(boundary: &Mesh, widened: &Mesh, surface: &Mesh, by: f64) -> Result<Mesh, NoUnion> {
    // What 64 bits leave of a vertex that lies on a face.
    let near = 1e-5 * by;
    let tree = BoxTree::new(widened, near);
    let moved = |&p: &DVec3| {
        let mut planes = Planes::NONE;
        let mut corner = None;
        tree.for_each_at(p, |t| {
            let corners = widened.corners(t as usize);
            if closest_point(corners, p).distance(p) > near {
                return;
            }
            let origin = surface.corners(t as usize);
            for (from, to) in corners.into_iter().zip(origin) {
                if from.distance(p) <= near {
                    corner = Some(to);
                }
            }
            let normal = normal(origin);
            planes.add(normal, (origin[0] - p).dot(normal), area(origin));
        });
        corner.unwrap_or_else(|| p + planes.way().clamp_length_max(MITER * by))
    };
    let vertices: Vec<_> = boundary.vertices().par_iter().map(moved).collect();
    // What came to one place but for rounding.
    let mut cells = Cells::new(near, surface.bounds().0);
    let mut kept: Vec<DVec3> = Vec::new();
    let mut one = |&v: &DVec3| {
        if let Some(same) = cells.find_near(v, |i| kept[i].distance(v) <= near) {
            return kept[same];
        }
        cells.push(v);
        kept.push(v);
        v
    };
    let vertices: Vec<_> = vertices.iter().map(&mut one).collect();
    without_edges(&vertices, boundary.triangles())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn together(meshes: &[Mesh]) -> Mesh {
        let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
        for mesh in meshes {
            let first = vertices.len() as u32;
            vertices.extend_from_slice(mesh.vertices());
            triangles.extend(mesh.triangles().iter().map(|t| t.map(|v| v + first)));
        }
        Mesh::new(&vertices, &triangles).unwrap()
    }

    fn cuboid(low: [f64; 3], high: [f64; 3]) -> Mesh {
        let (low, high) = (DVec3::from_array(low), DVec3::from_array(high));
        let mesh = Mesh::cuboid((high - low).to_array()).unwrap();
        let vertices = mesh.vertices().iter().map(|&v| v + low.midpoint(high));
        Mesh::new(&vertices.collect::<Vec<_>>(), mesh.triangles()).unwrap()
    }

    fn turned(mesh: &Mesh) -> Mesh {
        let turn = glamx::DQuat::from_euler(glamx::EulerRot::XYZ, 0.3, 0.7, 1.1);
        let vertices: Vec<_> = mesh.vertices().iter().map(|&v| turn * v).collect();
        Mesh::new(&vertices, mesh.triangles()).unwrap()
    }

    /// Boxes through, on and beside each other: the volume is that of all together, and the area has
    /// no inner walls.
    #[test]
    fn boxes_become_one_solid() {
        let base = cuboid([0.0; 3], [1.0; 3]);
        let cases = [
            (cuboid([1.0, 0.0, 0.0], [2.0, 1.0, 1.0]), 2.0, 10.0),
            (cuboid([1.0, 0.25, 0.25], [1.5, 0.75, 0.75]), 1.125, 7.0),
            (cuboid([0.5, 0.25, 0.25], [1.5, 0.75, 0.75]), 1.125, 7.0),
            (cuboid([0.25; 3], [0.75; 3]), 1.0, 6.0),
            (cuboid([1.00001, 0.0, 0.0], [2.0, 1.0, 1.0]), 2.0, 10.0),
            (cuboid([1.0 + 1e-9, 0.0, 0.0], [2.0, 1.0, 1.0]), 2.0, 10.0),
            (cuboid([1.0 - 1e-9, 0.0, 0.0], [2.0, 1.0, 1.0]), 2.0, 10.0),
        ];
        for (i, (other, expected_volume, expected_area)) in cases.into_iter().enumerate() {
            for turn in [false, true] {
                let parts = together(&[base.clone(), other.clone()]);
                let parts = if turn { turned(&parts) } else { parts };
                let found = layout(&parts);
                assert_ne!(found, Layout::Simple, "{i}");
                let united = union(&parts, found).unwrap();
                assert_ne!(layout(&united), Layout::WithGaps, "{i} {turn}");
                let (v, a) = (united.volume(), united.area());
                assert!((v - expected_volume).abs() < 1e-8, "{i} {turn}: {v}");
                assert!((a - expected_area).abs() < 1e-3, "{i} {turn}: {a}");
            }
        }
        assert_eq!(layout(&base), Layout::Simple);
        let apart = together(&[base.clone(), cuboid([1.001, 0.0, 0.0], [2.0, 1.0, 1.0])]);
        assert_eq!(layout(&apart), Layout::Simple);
    }

    #[test]
    fn a_surface_moves_as_its_faces_do() {
        let box_ = turned(&cuboid([0.0; 3], [1.0, 2.0, 3.0]));
        let moved = widened(&box_, 0.1).unwrap();
        assert!((moved.volume() - 1.2 * 2.2 * 3.2).abs() < 1e-6);
        let ball = Mesh::icosphere(1.0, 4).unwrap();
        let wide = widened(&ball, 1e-3).unwrap();
        let back = put_back(&wide, &wide, &ball, 1e-3).unwrap();
        assert_eq!(ball.vertices(), back.vertices());
    }
}
