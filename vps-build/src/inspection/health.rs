//! Health report of a mesh: defects that a build repairs or refuses.

use std::collections::HashMap;

use super::thin_walls::ThinWalls;
use crate::mesh::Mesh;
use crate::mesh::edges::Edges;
use crate::mesh::union_find::UnionFind;
use crate::spatial::bvh::Bvh;

/// A health report of a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Health {
    /// Distinct vertex positions.
    pub vertices: usize,
    /// Triangles, including bad ones.
    pub triangles: usize,
    /// Connected components, by shared vertices.
    pub components: usize,
    /// Edges with a single triangle.
    pub boundary_edges: usize,
    /// Holes: connected components of boundary edges.
    pub boundary_loops: usize,
    /// Edges with three triangles or more.
    pub non_manifold_edges: usize,
    /// Edges whose two triangles are oriented inconsistently.
    pub inconsistent_edges: usize,
    /// Triangles beyond the first with the same three vertices.
    pub duplicate_faces: usize,
    /// Triangles of zero area.
    pub degenerate_faces: usize,
    /// Area in m².
    pub area_m2: f64,
    /// Volume in m³, negative if the triangles face inwards. Unreliable for an open mesh.
    pub volume_m3: f64,
    /// Extents of the bounding box in metres.
    pub extents_m: [f64; 3],
    /// Fraction of the surface, from 0 to 1, with a wall behind it thinner than a voxel.
    pub thin_fraction: f64,
}

impl Health {
    /// The report of a mesh. Walls thinner than `voxel_size` metres count as thin.
    pub fn of(mesh: &Mesh, voxel_size: f64) -> Self {
        let triangles = mesh.triangles();
        let is_degenerate = |&t: &usize| {
            let [a, b, c] = mesh.corners(t);
            let longest = (b - a).length().max((c - b).length()).max((a - c).length());
            (b - a).cross(c - a).length() <= 1e-12 * longest * longest
        };
        let degenerate_faces = (0..triangles.len()).filter(is_degenerate).count();
        let mut same: HashMap<[u32; 3], usize> = HashMap::new();
        for triangle in triangles {
            let mut corners = *triangle;
            corners.sort_unstable();
            *same.entry(corners).or_default() += 1;
        }
        let duplicate_faces = same.values().map(|n| n - 1).sum();

        let mut parts = UnionFind::new(mesh.vertices().len());
        for &[a, b, c] in triangles {
            parts.join(a, b);
            parts.join(b, c);
        }
        let mut rims = UnionFind::new(mesh.vertices().len());
        let mut on_rim = Vec::new();
        let (mut boundary_edges, mut non_manifold_edges, mut inconsistent_edges) = (0, 0, 0);
        for uses in Edges::of(triangles).groups() {
            match uses {
                [edge] => {
                    boundary_edges += 1;
                    let (a, b) = edge.between;
                    rims.join(a, b);
                    on_rim.push(a);
                }
                [a, b] => inconsistent_edges += usize::from(a.forward == b.forward),
                _ => non_manifold_edges += 1,
            }
        }
        let used = triangles.iter().flatten().copied();
        let (low, high) = mesh.bounds();
        Self {
            vertices: mesh.vertices().len(),
            triangles: triangles.len(),
            components: parts.count(used),
            boundary_edges,
            boundary_loops: rims.count(on_rim.into_iter()),
            non_manifold_edges,
            inconsistent_edges,
            duplicate_faces,
            degenerate_faces,
            area_m2: mesh.area(),
            volume_m3: mesh.volume(),
            extents_m: (high - low).to_array(),
            thin_fraction: ThinWalls::sampled(mesh, &Bvh::new(mesh), 0.0..voxel_size).fraction,
        }
    }

    /// Whether the mesh is closed and consistently oriented, without duplicate triangles.
    pub fn is_watertight(&self) -> bool {
        self.boundary_edges == 0
            && self.non_manifold_edges == 0
            && self.inconsistent_edges == 0
            && self.duplicate_faces == 0
    }
}

#[cfg(test)]
mod tests {
    use glamx::DVec3;

    use super::*;

    fn health(vertices: &[DVec3], triangles: &[[u32; 3]]) -> Health {
        Health::of(&Mesh::new(vertices, triangles).unwrap(), 0.01)
    }

    #[test]
    fn a_box_is_healthy() {
        let health = Health::of(&Mesh::cuboid([1.0, 2.0, 3.0]).unwrap(), 0.1);
        assert!(health.is_watertight());
        assert_eq!((health.components, health.boundary_loops), (1, 0));
        assert!((health.volume_m3 - 6.0).abs() < 1e-9 && (health.area_m2 - 22.0).abs() < 1e-9);
        assert_eq!((health.thin_fraction, health.degenerate_faces), (0.0, 0));
        assert!(health.thin_fraction.is_sign_positive());
    }

    #[test]
    fn each_defect_is_counted() {
        let ball = Mesh::icosphere(0.5, 2).unwrap();
        let (v, t) = (ball.vertices(), ball.triangles());
        // Two holes, far from each other.
        let holes: Vec<_> = t[1..t.len() - 1].to_vec();
        let report = health(v, &holes);
        assert_eq!((report.boundary_edges, report.boundary_loops), (6, 2));
        let mut twice = t.to_vec();
        twice.push(t[5]);
        let report = health(v, &twice);
        assert_eq!((report.duplicate_faces, report.non_manifold_edges), (1, 3));
        let mut turned = t.to_vec();
        turned[7].reverse();
        assert_eq!(health(v, &turned).inconsistent_edges, 3);
        let mut flat = t.to_vec();
        flat.push([0, 0, 1]);
        assert_eq!(health(v, &flat).degenerate_faces, 1);
        // A second ball beside the first.
        let mut both = v.to_vec();
        both.extend(v.iter().map(|p| *p + DVec3::X * 3.0));
        let shifted = t.iter().map(|c| c.map(|i| i + v.len() as u32));
        let both_triangles: Vec<_> = t.iter().copied().chain(shifted).collect();
        assert_eq!(health(&both, &both_triangles).components, 2);
    }

    #[test]
    fn thin_walls_are_noticed() {
        let plate = Mesh::cuboid([1.0, 0.01, 1.0]).unwrap();
        assert!(Health::of(&plate, 0.02).thin_fraction > 0.9);
        assert!(Health::of(&plate, 0.005).thin_fraction == 0.0);
    }
}
