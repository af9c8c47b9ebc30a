//! The point of a triangle that is closest to another point, and on which side of the mesh that
//! other point lies.

use std::collections::HashMap;

use glamx::DVec3;

use crate::Mesh;

/// The part of a triangle a closest point lies on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Feature {
    /// The n-th corner.
    Vertex(usize),
    /// The edge from the n-th corner to the next.
    Edge(usize),
    Face,
}

/// The point of the triangle closest to `p`, by the Voronoi regions of its features (Ericson,
/// Real-Time Collision Detection, 5.1.5).
pub(crate) fn closest_point([a, b, c]: [DVec3; 3], p: DVec3) -> (DVec3, Feature) {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return (a, Feature::Vertex(0));
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return (b, Feature::Vertex(1));
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return (c, Feature::Vertex(2));
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return (a + ab * (d1 / (d1 - d3)), Feature::Edge(0));
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        let t = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return (b + (c - b) * t, Feature::Edge(1));
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return (a + ac * (d2 / (d2 - d6)), Feature::Edge(2));
    }
    let inverse = 1.0 / (va + vb + vc);
    (a + ab * (vb * inverse) + ac * (vc * inverse), Feature::Face)
}

/// Normals of all features of a mesh, such that their side is the side of the mesh: those of
/// vertices weighted by angle (Baerentzen and Aanaes, 2005).
pub(crate) struct Pseudonormals<'m> {
    mesh: &'m Mesh,
    vertices: Vec<DVec3>,
    edges: HashMap<(u32, u32), DVec3>,
}

impl<'m> Pseudonormals<'m> {
    pub(crate) fn new(mesh: &'m Mesh) -> Self {
        let mut vertices = vec![DVec3::ZERO; mesh.vertices().len()];
        let mut edges = HashMap::new();
        for (t, corners) in mesh.triangles().iter().enumerate() {
            let p = mesh.corners(t);
            let normal = (p[1] - p[0]).cross(p[2] - p[0]).normalize_or_zero();
            for i in 0..3 {
                let (next, previous) = ((i + 1) % 3, (i + 2) % 3);
                let angle = (p[next] - p[i]).angle_between(p[previous] - p[i]);
                if angle.is_finite() {
                    vertices[corners[i] as usize] += normal * angle;
                }
                let edge = ordered(corners[i], corners[next]);
                *edges.entry(edge).or_insert(DVec3::ZERO) += normal;
            }
        }
        Self {
            mesh,
            vertices,
            edges,
        }
    }

    /// Whether `p` lies behind the surface, given the closest point of the mesh and the feature of
    /// the triangle it lies on.
    pub(crate) fn is_inside(
        &self,
        p: DVec3,
        triangle: usize,
        (closest, feature): (DVec3, Feature),
    ) -> bool {
        let corners = self.mesh.triangles()[triangle];
        let normal = match feature {
            Feature::Vertex(i) => self.vertices[corners[i] as usize],
            Feature::Edge(i) => self.edges[&ordered(corners[i], corners[(i + 1) % 3])],
            Feature::Face => {
                let [a, b, c] = self.mesh.corners(triangle);
                (b - a).cross(c - a)
            }
        };
        (p - closest).dot(normal) < 0.0
    }
}

fn ordered(a: u32, b: u32) -> (u32, u32) {
    (a.min(b), a.max(b))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn vector() -> impl Strategy<Value = DVec3> {
        prop::array::uniform3(-2.0..2.0).prop_map(DVec3::from_array)
    }

    proptest! {
        /// No sampled point of the triangle is closer, and the point lies in the triangle.
        #[test]
        fn the_closest_point_is_closest(t in prop::array::uniform3(vector()), p in vector()) {
            let (closest, feature) = closest_point(t, p);
            let [a, b, c] = t;
            for i in 0..=20 {
                for j in 0..=20 - i {
                    let (u, v) = (f64::from(i) / 20.0, f64::from(j) / 20.0);
                    let q = a + (b - a) * u + (c - a) * v;
                    prop_assert!(p.distance(closest) <= p.distance(q) + 1e-12);
                }
            }
            match feature {
                Feature::Vertex(i) => prop_assert_eq!(closest, t[i]),
                Feature::Edge(i) => {
                    let (from, to) = (t[i], t[(i + 1) % 3]);
                    let detour = from.distance(closest) + closest.distance(to) - from.distance(to);
                    prop_assert!(detour.abs() < 1e-12);
                }
                Feature::Face => {
                    let normal = (b - a).cross(c - a);
                    prop_assert!((closest - a).dot(normal).abs() < 1e-9);
                }
            }
        }
    }
}
