//! The polygon of the selected contacts, and the scores of candidates for it.

use glamx::Vec3;
use wide::f32x4;

use super::weighting::{
    DepthWeighting, MIN_NORMAL_WEIGHT, MIN_WEIGHT, PLANARITY_TOLERANCE, distance_outside,
};
use crate::field::Discs;
use crate::query::contact::Contact;
use crate::simd::Vectors;

/// The convex polygon of the selected contacts.
pub(super) struct Polygon<const N: usize> {
    /// Corners in counter-clockwise order, not in the order of selection.
    corners: [Vec3; N],
    /// For each corner the edge to the next one.
    edges: [Edge; N],
    len: usize,
    /// Unit direction in which the area is seen, in the shell frame.
    along: Vec3,
    /// The penetration at the first corner, in metres.
    deepest: f32,
    /// Distance in metres within which a contact counts as resting.
    resting_distance: f32,
    /// Distance in metres, measured from the first corner outwards, at which the weight is one half.
    half_weight_distance: f32,
    /// The lowest penetration of contacts that score, in metres.
    pub(super) penetration_threshold: f32,
}

/// An edge of a polygon.
#[derive(Clone, Copy)]
struct Edge {
    /// Outward normal in the plane of the polygon, as long as the edge.
    outward: Vec3,
    /// The product of the normal with the vector from the first corner to the edge, in m².
    offset: f32,
    /// In metres.
    length: f32,
}

impl<const N: usize> Polygon<N> {
    pub(super) fn new(first: &Contact, along: Vec3, weighting: DepthWeighting) -> Self {
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
            resting_distance: weighting.resting_distance(),
            half_weight_distance: weighting.half_weight_distance(first.penetration),
            penetration_threshold: weighting.min_penetration(first.penetration, MIN_WEIGHT),
        }
    }

    /// The score of a contact; `None` if it adds nothing.
    pub(super) fn score(&self, contact: &Contact) -> Option<f32> {
        if self.has_corner(contact.position) {
            return None;
        }
        let position = Vectors::splat(contact.position);
        let penetration = f32x4::splat(contact.penetration);
        let score = self.scores(position, penetration).to_array()[0];
        (score > 0.0).then_some(score * self.normal_weight(contact.normal))
    }

    /// The contacts of sufficient weight that are off the plane through the first corner by more than
    /// the tolerance.
    #[inline(always)]
    pub(super) fn off_plane(&self, positions: Vectors, penetrations: f32x4) -> f32x4 {
        let offset = positions.minus(Vectors::splat(self.corners[0]));
        let in_plane = offset.dot(Vectors::splat(self.along)) + f32x4::splat(self.deepest);
        let off = (penetrations - in_plane).abs() - f32x4::splat(self.resting_distance);
        let is_sufficient = penetrations.simd_ge(f32x4::splat(self.penetration_threshold));
        is_sufficient & off.simd_gt(offset.length() * f32x4::splat(PLANARITY_TOLERANCE))
    }

    /// Whether a position is a corner, for which rounding could yield a positive area.
    pub(super) fn has_corner(&self, position: Vec3) -> bool {
        self.corners[..self.len].contains(&position)
    }

    /// The weight of a contact by its normal, up to 1.
    pub(super) fn normal_weight(&self, normal: Vec3) -> f32 {
        let cosine = normal.dot(self.along);
        MIN_NORMAL_WEIGHT + (1.0 - MIN_NORMAL_WEIGHT) * (cosine * cosine).min(1.0)
    }

    /// The scores of contacts, without the weights of their normals.
    #[inline(always)]
    pub(super) fn scores(&self, positions: Vectors, penetrations: f32x4) -> f32x4 {
        self.area_gains(positions, |_| f32x4::ZERO) * self.depth_weights(penetrations)
    }

    /// Upper bounds on the scores of contacts in discs, for any normal.
    #[inline(always)]
    pub(super) fn score_bounds(&self, discs: &Discs, penetrations: f32x4) -> f32x4 {
        // Exceeds the rounding error.
        const ROUNDING: f32 = 1.0 + 1e-5;
        let centers = Vectors::from(discs.centers);
        let radii = f32x4::new(discs.radii);
        let far = centers.minus(Vectors::splat(self.corners[0])).length() + radii;
        let reach = radii + far * 1e-6;
        self.area_gains(centers, |edge| reach * edge) * self.depth_weights(penetrations) * ROUNDING
    }

    #[inline(always)]
    fn depth_weights(&self, penetrations: f32x4) -> f32x4 {
        let distance_outside = -penetrations - f32x4::splat(distance_outside(self.deepest));
        let further = distance_outside.fast_max(f32x4::ZERO) / self.half_weight_distance;
        let depth_weights = f32x4::ONE / (further * further + 1.0);
        let is_sufficient = penetrations.simd_ge(f32x4::splat(self.penetration_threshold));
        is_sufficient & depth_weights
    }

    /// The gain of points: a length for a single corner, otherwise twice the area added outside of
    /// the polygon. `slack` is added to the gain beyond an edge of the given length (1 for a single
    /// corner).
    #[inline(always)]
    fn area_gains(&self, points: Vectors, slack: impl Fn(f32) -> f32x4) -> f32x4 {
        let from_first = points.minus(Vectors::splat(self.corners[0]));
        if self.len == 1 {
            return from_first.length() + slack(1.0);
        }
        let mut max_gain = f32x4::ZERO;
        for edge in &self.edges[..self.len] {
            max_gain = max_gain.fast_max(edge.gain(from_first) + slack(edge.length));
        }
        max_gain
    }

    /// Inserts a corner after the edge with the largest gain.
    pub(super) fn insert(&mut self, point: Vec3) {
        let from_first = Vectors::splat(point - self.corners[0]);
        let (mut behind, mut max_gain) = (0, f32::NEG_INFINITY);
        for (i, edge) in self.edges[..self.len].iter().enumerate() {
            let gain = edge.gain(from_first).to_array()[0];
            if gain > max_gain {
                (behind, max_gain) = (i, gain);
            }
        }
        self.corners.copy_within(behind + 1..self.len, behind + 2);
        self.edges.copy_within(behind + 1..self.len, behind + 2);
        self.corners[behind + 1] = point;
        self.len += 1;
        // A polygon of two corners has an edge in each direction.
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
    /// Twice the signed area of the triangles over the edge, positive outside of the polygon; for
    /// points relative to the first corner.
    #[inline(always)]
    fn gain(&self, from_first: Vectors) -> f32x4 {
        from_first.dot(Vectors::splat(self.outward)) - f32x4::splat(self.offset)
    }
}
