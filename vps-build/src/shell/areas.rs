//! The area of the surface that each point stands for.

use glamx::DVec3;
use rayon::prelude::*;
use vps_core::Vec3;

use super::poisson::PoissonDisk;
use crate::mesh::Mesh;
use crate::mesh::triangle::area;
use crate::spatial::kd_tree::KdTree;

/// The area in m² of the Voronoi cell of each point, among points on the same side of a thin wall.
/// Triangles are subdivided until their edges are at most half the spacing.
pub(super) fn voronoi_areas(mesh: &Mesh, disk: &PoissonDisk, normals: &[Vec3]) -> Vec<f32> {
    let positions = &disk.points;
    let tree = KdTree::new(positions);
    let longest = 0.25 * disk.spacing * disk.spacing;
    let triangles: Vec<_> = (0..mesh.triangles().len()).collect();
    let pieces: Vec<Vec<(usize, f64)>> = triangles
        .par_chunks(256)
        .map(|triangles| {
            let mut pieces = Vec::new();
            for &t in triangles {
                let triangle = mesh.corners(t);
                let [a, b, c] = triangle;
                let normal = (b - a).cross(c - a);
                let inward = -normal.as_vec3();
                for_each_piece(triangle, longest, &mut |[a, b, c]| {
                    let center = (a + b + c) / 3.0;
                    let faces = |p: &usize| normals[*p].dot(inward) >= 0.0;
                    // Most often the closest faces the piece, and a query for one is faster.
                    let closest = tree.closest(center, 1)[0];
                    let others = || tree.closest(center, CANDIDATES).into_iter();
                    let point = Some(closest).filter(faces).or_else(|| others().find(faces));
                    pieces.push((point.unwrap_or(closest), area([a, b, c])));
                });
            }
            pieces
        })
        .collect();
    let mut areas = vec![0.0; positions.len()];
    for (point, area) in pieces.into_iter().flatten() {
        areas[point] += area;
    }
    areas.into_iter().map(|a| a as f32).collect()
}

/// Points tried for one on the same side of a wall.
const CANDIDATES: usize = 4;

/// Bisects a triangle at its longest edge until no squared edge exceeds `longest`.
fn for_each_piece(triangle: [DVec3; 3], longest: f64, visit: &mut impl FnMut([DVec3; 3])) {
    let edge = |i: usize| triangle[i].distance_squared(triangle[(i + 1) % 3]);
    let at = (0..3).fold(0, |most, i| if edge(i) > edge(most) { i } else { most });
    if edge(at) <= longest {
        visit(triangle);
        return;
    }
    let [a, b, c] = [0, 1, 2].map(|i| triangle[(at + i) % 3]);
    let middle = a.midpoint(b);
    for_each_piece([a, middle, c], longest, visit);
    for_each_piece([middle, b, c], longest, visit);
}
