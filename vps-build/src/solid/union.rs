//! The boundary of the solid with winding number one or more.
//!
//! Where parts of a surface overlap or touch, some faces lie within the solid. The surface is cut
//! along its intersections, and faces with solid on both sides are removed (Zhou, Grinspun, Zorin
//! and Jacobson 2016). The crate `manifold-rust` does so in exact arithmetic.
//!
//! Parts with a rounding gap between them are joined too: the surface is offset outwards by half of
//! the gap tolerance, and the vertices of the union are moved back to their original faces.

use std::panic::{AssertUnwindSafe, catch_unwind};

use glamx::{DMat3, DVec3};
use manifold_rust::manifold::Manifold;
use manifold_rust::types::{Error, MeshGL64, WindingRule};
use rayon::prelude::*;
use rustc_hash::FxHashSet;

use super::bodies::Bodies;
use super::fans::Fans;
use super::self_contact::{SelfContact, gap_tolerance};
use crate::mesh::Mesh;
use crate::mesh::faces::{canonical_rotation, has_distinct_corners};
use crate::mesh::triangle::{area, closest_point, normal};
use crate::spatial::box_tree::BoxTree;
use crate::spatial::spatial_hash::SpatialHash;

/// Limit of a corner's displacement, in units of its faces' offset. As for miter joins of strokes.
const MITER_LIMIT: f64 = 4.0;

/// Whether faces of a surface may lie within its solid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Layout {
    /// The surface is the boundary of its solid.
    Simple,
    /// Faces may lie within the solid.
    Overlapping,
    /// As `Overlapping`, and some faces are closer than the gap tolerance.
    WithGaps,
}

/// The layout of a closed surface.
pub(super) fn layout(surface: &Mesh) -> Layout {
    let contact = SelfContact::of(surface, gap_tolerance(surface));
    if contact.has_gaps {
        Layout::WithGaps
    } else if contact.meets || !Bodies::of(surface).are_nested(surface) {
        Layout::Overlapping
    } else {
        Layout::Simple
    }
}

/// Why there is no union.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum UnionError {
    /// The solid is empty.
    Empty,
    /// The computation failed.
    Failed,
}

/// The boundary of the solid with winding number one or more.
pub(super) fn union(surface: &Mesh, layout: Layout) -> Result<Mesh, UnionError> {
    let half_gap = 0.5 * gap_tolerance(surface);
    if layout == Layout::WithGaps {
        let offset = offset_outwards(surface, half_gap)?;
        return undo_offset(&outer_boundary(&offset)?, &offset, surface, half_gap);
    }
    outer_boundary(surface)
}

fn outer_boundary(surface: &Mesh) -> Result<Mesh, UnionError> {
    // Relative to the centre, to keep digits.
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
    // A panic of the crate must not end the program.
    let output = catch_unwind(AssertUnwindSafe(|| {
        let solid = Manifold::from_mesh_gl64_robust(&input).rebuild_solid(WindingRule::Positive);
        (solid.status() == Error::NoError).then(|| solid.get_mesh_gl64(-1))
    }));
    let output = output.ok().flatten().ok_or(UnionError::Failed)?;
    if output.tri_verts.is_empty() {
        return Err(UnionError::Empty);
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
    let boundary = without_collapsed(&vertices, &triangles)?;
    if boundary.open_edges() > 0 {
        return Err(UnionError::Failed);
    }
    Ok(boundary)
}

/// The mesh without triangles that have two equal corners, or that cancel a triangle of the
/// opposite orientation.
fn without_collapsed(vertices: &[DVec3], triangles: &[[u32; 3]]) -> Result<Mesh, UnionError> {
    let new = |vertices: &[DVec3], triangles: &[[u32; 3]]| {
        Mesh::new(vertices, triangles).map_err(|_| UnionError::Failed)
    };
    let mesh = new(vertices, triangles)?;
    let mut remaining = mesh.triangles().to_vec();
    remaining.retain(has_distinct_corners);
    let present: FxHashSet<_> = remaining.iter().map(|&t| canonical_rotation(t)).collect();
    remaining.retain(|&[a, b, c]| !present.contains(&canonical_rotation([a, c, b])));
    if remaining.len() == mesh.triangles().len() {
        return Ok(mesh);
    }
    new(mesh.vertices(), &remaining)
}

/// A least-squares fit of a displacement to planes.
#[derive(Clone, Copy)]
struct PlaneFit {
    matrix: DMat3,
    side: DVec3,
    weight: f64,
}

impl PlaneFit {
    const NONE: Self = Self {
        matrix: DMat3::ZERO,
        side: DVec3::ZERO,
        weight: 0.0,
    };

    /// Adds a plane at `distance` metres along its unit normal.
    fn add(&mut self, normal: DVec3, distance: f64, weight: f64) {
        let columns = [normal.x, normal.y, normal.z].map(|c| normal * (c * weight));
        self.matrix += DMat3::from_cols(columns[0], columns[1], columns[2]);
        self.side += normal * (distance * weight);
        self.weight += weight;
    }

    /// The shortest displacement to all planes, in the least-squares sense.
    fn displacement(&self) -> DVec3 {
        // Damped: no displacement along directions without a plane.
        let damped = self.matrix + DMat3::from_diagonal(DVec3::splat(DAMPING * self.weight));
        let displacement = damped.inverse() * self.side;
        if displacement.is_finite() {
            displacement
        } else {
            DVec3::ZERO
        }
    }
}

/// Weight of the damping, relative to the weight of all planes.
const DAMPING: f64 = 1e-9;

/// The surface with its faces moved outwards by `by` metres. Each corner of a body moves to the
/// offset planes of its faces.
fn offset_outwards(surface: &Mesh, by: f64) -> Result<Mesh, UnionError> {
    let fans = Fans::of(surface, 2.0 * by);
    let mut planes = vec![PlaneFit::NONE; fans.vertices.len()];
    for (t, corners) in fans.of_triangles.iter().enumerate() {
        let at = surface.corners(t);
        for &fan in corners {
            planes[fan as usize].add(normal(at), by, area(at));
        }
    }
    let vertices = fans.vertices.iter().zip(&planes);
    let moved = |(&v, planes): (&u32, &PlaneFit)| {
        surface.vertices()[v as usize] + planes.displacement().clamp_length_max(MITER_LIMIT * by)
    };
    let vertices: Vec<_> = vertices.map(moved).collect();
    Mesh::new(&vertices, &fans.of_triangles).map_err(|_| UnionError::Failed)
}

/// Moves the vertices of a boundary from faces of the offset surface to the same faces of the
/// original.
fn undo_offset(
    boundary: &Mesh,
    offset: &Mesh,
    surface: &Mesh,
    by: f64,
) -> Result<Mesh, UnionError> {
    // Rounding of a vertex on a face.
    let near = 1e-5 * by;
    let tree = BoxTree::new(offset, near);
    let moved = |&p: &DVec3| {
        let mut planes = PlaneFit::NONE;
        let mut corner = None;
        tree.for_each_at(p, |t| {
            let corners = offset.corners(t as usize);
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
        corner.unwrap_or_else(|| p + planes.displacement().clamp_length_max(MITER_LIMIT * by))
    };
    let vertices: Vec<_> = boundary.vertices().par_iter().map(moved).collect();
    // Merges vertices that are equal up to rounding.
    let mut hash = SpatialHash::new(near, surface.bounds().0);
    let mut kept: Vec<DVec3> = Vec::new();
    let mut one = |&v: &DVec3| {
        if let Some(same) = hash.find_near(v, |i| kept[i].distance(v) <= near) {
            return kept[same];
        }
        hash.insert(v);
        kept.push(v);
        v
    };
    let vertices: Vec<_> = vertices.iter().map(&mut one).collect();
    without_collapsed(&vertices, boundary.triangles())
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

    /// Boxes across, on and beside each other. The union has their common volume and no inner
    /// walls.
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
        let moved = offset_outwards(&box_, 0.1).unwrap();
        assert!((moved.volume() - 1.2 * 2.2 * 3.2).abs() < 1e-6);
        let ball = Mesh::icosphere(1.0, 4).unwrap();
        let wide = offset_outwards(&ball, 1e-3).unwrap();
        let back = undo_offset(&wide, &wide, &ball, 1e-3).unwrap();
        assert_eq!(ball.vertices(), back.vertices());
    }
}
