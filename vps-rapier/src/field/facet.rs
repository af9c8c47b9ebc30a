//! A triangle of a surface, and how it meets its neighbours.

use vps_core::{Aabb, Vec3};

/// How the triangles at an edge or a vertex meet, seen from the side they face.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Junction {
    /// Unit mean of the normals of the triangles, weighted by angle at a vertex; zero if they cancel.
    pub(crate) pseudonormal: Vec3,
    /// Cosine between the pseudonormal and the triangle's normal furthest from it.
    pub(crate) opening: f32,
    /// Whether the surface ends here.
    pub(crate) is_border: bool,
    /// Whether some of the triangles bend towards the side they face.
    pub(crate) is_concave: bool,
    /// Width of the narrowest of the triangles at an edge, in metres; 0 at a vertex, where it is not
    /// computed.
    pub(crate) width: f32,
}

/// Opening from which triangles count as coplanar: single precision does not separate normals that
/// are closer.
const COPLANAR_COSINE: f32 = 1.0 - 1e-6;

impl Junction {
    /// The junction of triangles given by their unit normals and weights.
    pub(crate) fn of_normals(normals: impl Iterator<Item = (Vec3, f32)> + Clone) -> Self {
        let sum: Vec3 = normals.clone().map(|(n, weight)| n * weight).sum();
        let pseudonormal = sum.normalize_or_zero();
        let opening = normals
            .map(|(n, _)| n.dot(pseudonormal))
            .fold(1.0, f32::min);
        Self {
            pseudonormal,
            opening,
            ..Self::default()
        }
    }

    /// Whether all triangles that meet lie in one plane.
    pub(crate) fn is_flat(&self) -> bool {
        !self.is_border && self.opening > COPLANAR_COSINE
    }

    /// Whether the points of a shell may miss this edge. True for borders, for ridges with an opening
    /// below `max_opening`, and for any ridge at a triangle narrower than `min_width` metres.
    pub(crate) fn may_be_missed(&self, max_opening: f32, min_width: f32) -> bool {
        let is_ridge = !self.is_concave && self.opening < COPLANAR_COSINE;
        let is_missed = self.opening < max_opening || self.width < min_width;
        self.is_border || is_ridge && is_missed
    }
}

/// A triangle with its neighbours taken into account.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Facet {
    /// Index of the triangle in the shape.
    pub(crate) number: u32,
    /// In metres, in the frame of the shape.
    pub(crate) corners: [Vec3; 3],
    /// Unit normal out of the side the triangle faces.
    pub(crate) normal: Vec3,
    /// The edge from each corner to the next.
    pub(crate) edges: [Junction; 3],
    /// Whether the edge also belongs to an earlier facet.
    pub(crate) is_shared: [bool; 3],
    /// The vertex at each corner.
    pub(crate) vertices: [Junction; 3],
}

impl Facet {
    /// A facet without neighbours.
    pub(crate) fn new(number: u32, corners: [Vec3; 3], normal: Vec3) -> Self {
        Self {
            number,
            corners,
            normal,
            edges: [Junction::default(); 3],
            is_shared: [false; 3],
            vertices: [Junction::default(); 3],
        }
    }

    pub(crate) fn bounds(&self) -> Aabb {
        let [a, b, c] = self.corners;
        Aabb {
            min: a.min(b).min(c),
            max: a.max(b).max(c),
        }
    }

    /// Signed height of a point above the plane of the facet.
    #[inline]
    pub(crate) fn height(&self, point: Vec3) -> f32 {
        (point - self.corners[0]).dot(self.normal)
    }

    /// The smallest of the three heights of the triangle.
    pub(crate) fn width(&self) -> f32 {
        let [a, b, c] = self.corners;
        let longest = (b - a).length().max((c - b).length()).max((a - c).length());
        (b - a).cross(c - a).length() / longest
    }

    /// The interior angle at a corner, in radians.
    pub(crate) fn angle(&self, corner: usize) -> f32 {
        let at = |i: usize| self.corners[i % 3] - self.corners[corner];
        at(corner + 1).angle_between(at(corner + 2))
    }
}
