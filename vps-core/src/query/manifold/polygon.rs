//! The polygon of the picked points.

use glamx::Vec3;
use wide::f32x4;

use super::weighting::{ASKEW, BENT, Closeness, LEAST_WEIGHT, outside};
use crate::field::Discs;
use crate::query::contact::Contact;
use crate::simd::Vectors;

/// The picked points as a polygon that grows.
pub(super) struct Polygon<const N: usize> {
    /// Corners in order, counter-clockwise, which is not the order of picking.
    corners: [Vec3; N],
    /// For each corner the edge to the next one.
    edges: [Edge; N],
    len: usize,
    along: Vec3,
    /// The penetration at the first corner, in metres.
    deepest: f32,
    /// What is no distance to speak of, in metres.
    close: f32,
    /// How much further outside a contact counts half, in metres.
    half: f32,
    /// From which penetration on contacts count enough.
    pub(super) least: f32,
}

/// An edge of a polygon.
#[derive(Clone, Copy)]
struct Edge {
    /// The outward direction in the plane of the polygon, as long as the edge.
    outward: Vec3,
    /// How far that way the edge is from the first corner, in square metres.
    offset: f32,
    /// In metres.
    length: f32,
}

impl<const N: usize> Polygon<N> {
    pub(super) fn new(first: &Contact, along: Vec3, closeness: Closeness) -> Self {
        Self {
            corners: [first.position; N],
            edges: [Edge {
                outward: Vec3::ZERO,
                offset: 0.0,
                length: 0.0,
            }; N],
            len: 1,
            along,
            deepest: first.penetration,
            close: closeness.close(),
            half: closeness.half(first.penetration),
            least: closeness.least_deep(first.penetration, LEAST_WEIGHT),
        }
    }

    /// What a contact adds, weighted; `None` if nothing.
    pub(super) fn score(&self, contact: &Contact) -> Option<f32> {
        if self.has_corner(contact.position) {
            return None;
        }
        let position = Vectors::splat(contact.position);
        let penetration = f32x4::splat(contact.penetration);
        let score = self.scores(position, penetration).to_array()[0];
        (score > 0.0).then_some(score * self.facing(contact.normal))
    }

    /// Which of the contacts that count are off the plane through the first corner, further than
    /// what is flat makes of it.
    #[inline(always)]
    pub(super) fn bent(&self, positions: Vectors, penetrations: f32x4) -> f32x4 {
        let way = positions.minus(Vectors::splat(self.corners[0]));
        let in_plane = way.dot(Vectors::splat(self.along)) + f32x4::splat(self.deepest);
        let off = (penetrations - in_plane).abs() - f32x4::splat(self.close);
        let counts = penetrations.simd_ge(f32x4::splat(self.least));
        counts & off.simd_gt(way.length() * f32x4::splat(BENT))
    }

    /// Rounding would make area of nothing for those.
    pub(super) fn has_corner(&self, position: Vec3) -> bool {
        self.corners[..self.len].contains(&position)
    }

    /// How much a contact counts by its normal, up to one: less where the shell bends away.
    pub(super) fn facing(&self, normal: Vec3) -> f32 {
        let cosine = normal.dot(self.along);
        ASKEW + (1.0 - ASKEW) * (cosine * cosine).min(1.0)
    }

    /// What contacts add, weighted, but for their normals.
    #[inline(always)]
    pub(super) fn scores(&self, positions: Vectors, penetrations: f32x4) -> f32x4 {
        self.gains(positions, |_| f32x4::ZERO) * self.weights(penetrations)
    }

    /// The highest score of any contact in a disc, whatever its normal.
    #[inline(always)]
    pub(super) fn bounds(&self, discs: &Discs, penetrations: f32x4) -> f32x4 {
        // More than rounding can make of it.
        const ROUNDED: f32 = 1.0 + 1e-5;
        let centers = Vectors::from(discs.centers);
        let radii = f32x4::new(discs.radii);
        let far = centers.minus(Vectors::splat(self.corners[0])).length() + radii;
        let reach = radii + far * 1e-6;
        self.gains(centers, |edge| reach * edge) * self.weights(penetrations) * ROUNDED
    }

    #[inline(always)]
    fn weights(&self, penetrations: f32x4) -> f32x4 {
        let outside = -penetrations - f32x4::splat(outside(self.deepest));
        let further = outside.fast_max(f32x4::ZERO) / self.half;
        let weights = f32x4::ONE / (further * further + 1.0);
        let counts = penetrations.simd_ge(f32x4::splat(self.least));
        counts & weights
    }

    /// How much points add: a length for a single corner, otherwise twice an area, only what lies
    /// outside of the polygon; `more` is how much more it may be beyond an edge of that length (one
    /// for a single corner).
    #[inline(always)]
    fn gains(&self, points: Vectors, more: impl Fn(f32) -> f32x4) -> f32x4 {
        let from_first = points.minus(Vectors::splat(self.corners[0]));
        if self.len == 1 {
            return from_first.length() + more(1.0);
        }
        let mut most = f32x4::ZERO;
        for edge in &self.edges[..self.len] {
            most = most.fast_max(edge.beyond(from_first) + more(edge.length));
        }
        most
    }

    /// Puts a corner in behind the edge it adds the most to.
    pub(super) fn insert(&mut self, point: Vec3) {
        let from_first = Vectors::splat(point - self.corners[0]);
        let (mut behind, mut most) = (0, f32::NEG_INFINITY);
        for (i, edge) in self.edges[..self.len].iter().enumerate() {
            let gain = edge.beyond(from_first).to_array()[0];
            if gain > most {
                (behind, most) = (i, gain);
            }
        }
        self.corners.copy_within(behind + 1..self.len, behind + 2);
        self.edges.copy_within(behind + 1..self.len, behind + 2);
        self.corners[behind + 1] = point;
        self.len += 1;
        // With two corners there is an edge each way.
        for i in [behind, behind + 1] {
            self.edges[i] = self.edge(i);
        }
    }

    /// The edge from a corner to the next one.
    fn edge(&self, corner: usize) -> Edge {
        let from = self.corners[corner];
        let to_next = self.corners[(corner + 1) % self.len] - from;
        let outward = to_next.cross(self.along);
        Edge {
            outward,
            offset: outward.dot(from - self.corners[0]),
            length: outward.length(),
        }
    }
}

impl Edge {
    /// Twice the area of the triangles over the edge, positive outside of the polygon; of points
    /// seen from the first corner.
    #[inline(always)]
    fn beyond(&self, from_first: Vectors) -> f32x4 {
        from_first.dot(Vectors::splat(self.outward)) - f32x4::splat(self.offset)
    }
}
