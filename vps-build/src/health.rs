//! What is wrong with a mesh, if anything.

use std::collections::HashMap;

use crate::Mesh;
use crate::bvh::Bvh;
use crate::edges::Edges;
use crate::thin_walls::ThinWalls;

/// A health report of a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Health {
    /// Different places of vertices.
    pub vertices: usize,
    /// Triangles, the bad ones included.
    pub triangles: usize,
    /// Parts that share no vertex.
    pub components: usize,
    /// Edges with one triangle only.
    pub boundary_edges: usize,
    /// Holes: sets of boundary edges that hang together.
    pub boundary_loops: usize,
    /// Edges with three triangles or more.
    pub non_manifold_edges: usize,
    /// Edges whose two triangles do not face the same way.
    pub inconsistent_edges: usize,
    /// Triangles beyond the first with the same three vertices.
    pub duplicate_faces: usize,
    /// Triangles without an area.
    pub degenerate_faces: usize,
    /// Area in m².
    pub area_m2: f64,
    /// Volume in m³, negative if the triangles face inwards; means little for an open mesh.
    pub volume_m3: f64,
    /// Lengths of the box around the mesh in metres.
    pub extents_m: [f64; 3],
    /// Share of the surface, from 0 to 1, behind which the other side of a wall is closer than a
    /// voxel.
    pub thin_share: f64,
}

impl Health {
    /// Looks at a mesh; walls count as thin below `voxel_size` metres.
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
            thin_share: ThinWalls::sampled(mesh, &Bvh::new(mesh), 0.0..voxel_size).share,
        }
    }

    /// Whether the mesh is closed, faces one way, and has no triangle twice.
    pub fn is_watertight(&self) -> bool {
        self.boundary_edges == 0
            && self.non_manifold_edges == 0
            && self.inconsistent_edges == 0
            && self.duplicate_faces == 0
    }
}

/// Sets of vertices that hang together.
pub(crate) struct UnionFind(Vec<u32>);

impl UnionFind {
    pub(crate) fn new(count: usize) -> Self {
        Self((0..count as u32).collect())
    }

    pub(crate) fn root(&mut self, mut v: u32) -> u32 {
        while self.0[v as usize] != v {
            let above = self.0[self.0[v as usize] as usize];
            self.0[v as usize] = above;
            v = above;
        }
        v
    }

    pub(crate) fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b) as usize] = a.min(b);
    }

    /// In how many sets these vertices are.
    fn count(&mut self, vertices: impl Iterator<Item = u32>) -> usize {
        let mut roots: Vec<_> = vertices.map(|v| self.root(v)).collect();
        roots.sort_unstable();
        roots.dedup();
        roots.len()
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
        assert_eq!((health.thin_share, health.degenerate_faces), (0.0, 0));
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
        // Another ball beside it.
        let mut both = v.to_vec();
        both.extend(v.iter().map(|p| *p + DVec3::X * 3.0));
        let shifted = t.iter().map(|c| c.map(|i| i + v.len() as u32));
        let both_triangles: Vec<_> = t.iter().copied().chain(shifted).collect();
        assert_eq!(health(&both, &both_triangles).components, 2);
    }

    #[test]
    fn thin_walls_are_noticed() {
        let plate = Mesh::cuboid([1.0, 0.01, 1.0]).unwrap();
        assert!(Health::of(&plate, 0.02).thin_share > 0.9);
        assert!(Health::of(&plate, 0.005).thin_share == 0.0);
    }
}
