//! Triangle meshes: the type, its geometry and topology, mass properties, the local frame of an asset,
//! and readers of files.

pub(crate) mod edges;
pub(crate) mod faces;
pub(crate) mod frame;
pub(crate) mod mass;
pub(crate) mod read;
pub(crate) mod sheet;
pub(crate) mod triangle;
pub(crate) mod union_find;

use glamx::DVec3;
use rustc_hash::{FxBuildHasher, FxHashMap};

use self::edges::Edges;

/// A validated triangle mesh in metres: its triangles refer to finite vertices, and it has an extent.
#[derive(Clone, Debug)]
pub struct Mesh {
    vertices: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
}

/// Why vertices and triangles are not a [`Mesh`].
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum MeshError {
    /// There are no triangles.
    #[error("the mesh has no triangles")]
    NoTriangles,
    /// A vertex that triangles use is NaN, infinite, or further from the origin than
    /// [`Mesh::LARGEST`].
    #[error("vertex {vertex} (counted from 0) {}", position_fault(*position).unwrap_or_default())]
    Vertex {
        /// The vertex.
        vertex: usize,
        /// Its position in metres.
        position: DVec3,
    },
    /// A triangle refers to a vertex that is not there.
    #[error(
        "triangle {triangle} (counted from 0) refers to vertex {vertex}, but there are {count}"
    )]
    Index {
        /// The triangle.
        triangle: usize,
        /// The missing vertex.
        vertex: u32,
        /// Number of vertices.
        count: usize,
    },
    /// All triangles lie in a point or on a line parallel to an axis.
    #[error("the mesh has no extent: its triangles span {0:e} x {1:e} x {2:e} m")]
    NoExtent(f64, f64, f64),
    /// The scale is not positive.
    #[error("the scale must be positive and finite, not {0}")]
    Scale(f64),
}

/// Why a vertex cannot be at a position, if it cannot.
pub(crate) fn position_fault(position: DVec3) -> Option<&'static str> {
    if !position.is_finite() {
        return Some("is not finite");
    }
    let is_far = position.abs().max_element() > Mesh::LARGEST;
    is_far.then_some("is further from the origin than any solid: coordinates reach up to 1e15")
}

impl Mesh {
    /// The largest coordinate in metres. Numbers are an eighth apart there, and areas still fit 32
    /// bits. A mesh smaller than its reciprocal counts as a point.
    pub const LARGEST: f64 = 1e15;

    /// A mesh of `triangles` over `vertices` (metres), counter-clockwise seen from outside.
    /// Vertices at the same position are welded, so that triangles that meet there are neighbours.
    ///
    /// # Errors
    /// When there is no triangle, a vertex of one is not finite or too far away, an index is out of
    /// range, or the mesh has no extent along two axes or more.
    pub fn new(vertices: &[DVec3], triangles: &[[u32; 3]]) -> Result<Self, MeshError> {
        if triangles.is_empty() {
            return Err(MeshError::NoTriangles);
        }
        for (triangle, corners) in triangles.iter().enumerate() {
            if let Some(&vertex) = corners.iter().find(|&&v| v as usize >= vertices.len()) {
                return Err(MeshError::Index {
                    triangle,
                    vertex,
                    count: vertices.len(),
                });
            }
            for &v in corners {
                let position = vertices[v as usize];
                if position_fault(position).is_some() {
                    let vertex = v as usize;
                    return Err(MeshError::Vertex { vertex, position });
                }
            }
        }
        let mesh = Self::welded(vertices, triangles);
        let extents = mesh.bounds().1 - mesh.bounds().0;
        let is_some = |&&extent: &&f64| extent > 1.0 / Self::LARGEST;
        if extents.to_array().iter().filter(is_some).count() < 2 {
            return Err(MeshError::NoExtent(extents.x, extents.y, extents.z));
        }
        Ok(mesh)
    }

    fn welded(vertices: &[DVec3], triangles: &[[u32; 3]]) -> Self {
        let mut first_at = FxHashMap::with_capacity_and_hasher(vertices.len(), FxBuildHasher);
        let mut kept = Vec::new();
        let mut weld = |v: u32| {
            let position = vertices[v as usize];
            // Adding 0 makes -0 and 0 equal.
            let key = (position + 0.0).to_array().map(f64::to_bits);
            *first_at.entry(key).or_insert_with(|| {
                kept.push(position);
                kept.len() as u32 - 1
            })
        };
        let triangles = triangles.iter().map(|t| t.map(&mut weld)).collect();
        Self {
            vertices: kept,
            triangles,
        }
    }

    /// A box around the origin with edges of `extents` metres, of twelve triangles.
    ///
    /// # Errors
    /// When two extents or more are zero, or one is not finite.
    pub fn cuboid(extents: [f64; 3]) -> Result<Self, MeshError> {
        let half = DVec3::from_array(extents) * 0.5;
        let corner = |i: u32| {
            let sign = |bit: u32| if i >> bit & 1 == 1 { 1.0 } else { -1.0 };
            half * DVec3::new(sign(0), sign(1), sign(2))
        };
        let vertices: Vec<_> = (0..8).map(corner).collect();
        let faces = [
            [0, 4, 6, 2],
            [1, 3, 7, 5],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 2, 3, 1],
            [4, 5, 7, 6],
        ];
        let triangles: Vec<_> = faces
            .iter()
            .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]])
            .collect();
        Self::new(&vertices, &triangles)
    }

    /// A ball around the origin: an icosahedron subdivided `subdivisions` times, with vertices at
    /// `radius` metres. It has 20 * 4^subdivisions triangles.
    ///
    /// # Errors
    /// When the radius is zero or not finite.
    pub fn icosphere(radius: f64, subdivisions: u32) -> Result<Self, MeshError> {
        let golden = f64::midpoint(1.0, 5.0_f64.sqrt());
        let mut vertices: Vec<DVec3> = Vec::new();
        for (a, b) in [
            (1.0, golden),
            (-1.0, golden),
            (1.0, -golden),
            (-1.0, -golden),
        ] {
            vertices.push(DVec3::new(0.0, a, b));
            vertices.push(DVec3::new(a, b, 0.0));
            vertices.push(DVec3::new(b, 0.0, a));
        }
        // Faces are triples of vertices at the edge length, 2, from each other.
        let near = |a: usize, b: usize| vertices[a].distance_squared(vertices[b]) < 4.1;
        let mut triangles = Vec::new();
        for a in 0..12 {
            for b in a + 1..12 {
                for c in b + 1..12 {
                    if near(a, b) && near(b, c) && near(a, c) {
                        let [p, q, r] = [a, b, c].map(|v| vertices[v]);
                        let outward = (q - p).cross(r - p).dot(p + q + r) > 0.0;
                        let face = if outward { [a, b, c] } else { [a, c, b] };
                        triangles.push(face.map(|v| v as u32));
                    }
                }
            }
        }
        let mut ball = Self {
            vertices,
            triangles,
        };
        for _ in 0..subdivisions {
            ball = ball.subdivided();
            for v in &mut ball.vertices {
                *v = v.normalize();
            }
        }
        let vertices: Vec<_> = ball
            .vertices
            .iter()
            .map(|v| v.normalize() * radius)
            .collect();
        Self::new(&vertices, &ball.triangles)
    }

    /// The same surface with four times as many triangles: each is divided at the midpoints of its edges.
    #[must_use]
    pub fn subdivided(&self) -> Self {
        let mut vertices = self.vertices.clone();
        let mut middles = FxHashMap::default();
        let mut triangles = Vec::with_capacity(4 * self.triangles.len());
        for &[a, b, c] in &self.triangles {
            let mut middle = |a: u32, b: u32| {
                *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                    vertices.push(vertices[a as usize].midpoint(vertices[b as usize]));
                    vertices.len() as u32 - 1
                })
            };
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            triangles.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        Self {
            vertices,
            triangles,
        }
    }

    /// The mesh with all coordinates multiplied by `scale`.
    ///
    /// # Errors
    /// When the scale is not positive and finite, or makes a coordinate infinite or all extents 0.
    pub fn scaled(&self, scale: f64) -> Result<Self, MeshError> {
        if !(scale > 0.0 && scale.is_finite()) {
            return Err(MeshError::Scale(scale));
        }
        if scale == 1.0 {
            return Ok(self.clone());
        }
        let vertices: Vec<_> = self.vertices.iter().map(|&v| v * scale).collect();
        Self::new(&vertices, &self.triangles)
    }

    /// The mesh translated by a vector in metres. Rounding may bend it slightly; its triangles stay.
    pub(crate) fn translated(&self, by: DVec3) -> Self {
        Self {
            vertices: self.vertices.iter().map(|&v| v + by).collect(),
            triangles: self.triangles.clone(),
        }
    }

    /// A mesh of other triangles over the same vertices.
    pub(crate) fn with_triangles(&self, triangles: Vec<[u32; 3]>) -> Self {
        Self {
            vertices: self.vertices.clone(),
            triangles,
        }
    }

    /// All vertices in metres.
    pub fn vertices(&self) -> &[DVec3] {
        &self.vertices
    }

    /// All triangles as indices into [`vertices`](Self::vertices).
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The corners of a triangle.
    ///
    /// # Panics
    /// When there is no such triangle.
    pub fn corners(&self, triangle: usize) -> [DVec3; 3] {
        self.triangles[triangle].map(|v| self.vertices[v as usize])
    }

    /// The lowest and the highest corner of the bounding box, in metres.
    pub fn bounds(&self) -> (DVec3, DVec3) {
        let start = (self.vertices[0], self.vertices[0]);
        self.vertices
            .iter()
            .fold(start, |(min, max), &v| (min.min(v), max.max(v)))
    }

    /// The number of edges without a matching triangle on each side: 0 for a closed, consistently
    /// oriented mesh.
    pub fn open_edges(&self) -> usize {
        Edges::of(&self.triangles).open_count()
    }

    /// Area of all triangles in m².
    pub fn area(&self) -> f64 {
        let triangles = 0..self.triangles.len();
        triangles.map(|t| triangle::area(self.corners(t))).sum()
    }

    /// The volume of a closed mesh in m³, negative if its triangles face inwards.
    pub(crate) fn volume(&self) -> f64 {
        let (low, _) = self.bounds();
        let triangles = 0..self.triangles.len();
        triangles
            .map(|t| triangle::signed_volume(self.corners(t), low))
            .sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapes_are_closed_and_face_outwards() {
        for mesh in [
            Mesh::cuboid([1.0, 2.0, 3.0]).unwrap(),
            Mesh::icosphere(0.5, 2).unwrap(),
        ] {
            assert_eq!(mesh.open_edges(), 0);
            let holed = Mesh::new(mesh.vertices(), &mesh.triangles()[1..]).unwrap();
            assert_eq!(holed.open_edges(), 3);
            let mut turned = mesh.triangles().to_vec();
            turned[0].reverse();
            assert_eq!(Mesh::new(mesh.vertices(), &turned).unwrap().open_edges(), 3);
            for t in 0..mesh.triangles().len() {
                let [a, b, c] = mesh.corners(t);
                assert!((b - a).cross(c - a).dot(a + b + c) > 0.0);
            }
        }
        assert_eq!(Mesh::icosphere(1.0, 2).unwrap().triangles().len(), 320);
        assert!((Mesh::cuboid([1.0, 2.0, 3.0]).unwrap().area() - 22.0).abs() < 1e-12);
    }

    #[test]
    fn vertices_at_one_place_are_one() {
        let v = [DVec3::ZERO, DVec3::X, DVec3::Y, -DVec3::ZERO, DVec3::Z];
        let mesh = Mesh::new(&v, &[[0, 1, 2], [3, 2, 4]]).unwrap();
        assert_eq!(mesh.vertices().len(), 4);
        assert_eq!(mesh.triangles()[1][0], 0);
    }

    #[test]
    fn nonsense_is_refused() {
        let v = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::X * 2.0];
        let error = |v: &[DVec3], t: &[[u32; 3]]| Mesh::new(v, t).unwrap_err();
        assert_eq!(error(&v, &[]), MeshError::NoTriangles);
        assert!(matches!(
            error(&v, &[[0, 1, 9]]),
            MeshError::Index { vertex: 9, .. }
        ));
        for misplaced in [DVec3::NAN, DVec3::Y * 1.1e15] {
            let nonsense = [v[0], v[1], misplaced];
            let error = error(&nonsense, &[[0, 1, 2]]);
            assert!(
                matches!(error, MeshError::Vertex { vertex: 2, .. }),
                "{error}"
            );
            // An unused vertex does not matter.
            let unused = [v[0], v[1], v[2], misplaced];
            assert!(Mesh::new(&unused, &[[0, 1, 2]]).is_ok());
        }
        assert!(matches!(error(&v, &[[0, 1, 3]]), MeshError::NoExtent(..)));
        let tiny = v.map(|v| v * 1e-305);
        assert!(matches!(
            error(&tiny, &[[0, 1, 2]]),
            MeshError::NoExtent(..)
        ));
        let mesh = Mesh::new(&v, &[[0, 1, 2]]).unwrap();
        assert!(matches!(mesh.scaled(0.0), Err(MeshError::Scale(_))));
    }
}
