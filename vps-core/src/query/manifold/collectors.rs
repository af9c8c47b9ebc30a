//! The collectors of contact reduction: the best candidate, and any contact off the plane.

use wide::f32x4;

use super::polygon::Polygon;
use crate::field::Discs;
use crate::query::collectors::{Collector, TestedPoints};
use crate::query::contact::Contact;
use crate::query::observer::Score;
use crate::simd::lanes_in;

/// Keeps the candidate with the highest score for a polygon.
pub(super) struct BestCandidate<'p, const N: usize> {
    pub(super) polygon: &'p Polygon<N>,
    /// Contacts from this penetration on, in metres, were added already.
    pub(super) added_from: f32,
    pub(super) threshold: f32,
    pub(super) found: Option<Contact>,
}

impl<const N: usize> Collector for BestCandidate<'_, N> {
    const BEST_FIRST: bool = true;
    const SCORE: Score = Score::Gain;

    #[inline(always)]
    fn score_bounds(&self, discs: &Discs, penetrations: f32x4) -> f32x4 {
        let remaining = penetrations.fast_min(f32x4::splat(self.added_from));
        self.polygon.score_bounds(discs, remaining)
    }

    #[inline(always)]
    fn threshold(&self) -> f32 {
        self.threshold
    }

    #[inline(always)]
    fn penetration_threshold(&self) -> f32 {
        self.polygon.penetration_threshold
    }

    #[inline(always)]
    fn add(&mut self, found: &TestedPoints<'_>) -> bool {
        let scores = self.polygon.scores(found.positions, found.penetrations);
        for lane in lanes_in(found.contact_mask & scores.simd_ge(f32x4::splat(self.threshold))) {
            self.consider(found.contact(lane), scores.to_array()[lane]);
        }
        true
    }
}

impl<const N: usize> BestCandidate<'_, N> {
    /// Keeps a contact if its score is the highest so far; `score` is without the weight of its
    /// normal.
    pub(super) fn consider(&mut self, contact: Contact, score: f32) {
        let score = score * self.polygon.normal_weight(contact.normal);
        let is_better = match &self.found {
            Some(best) => {
                score > self.threshold
                    || score == self.threshold && contact.point_index < best.point_index
            }
            None => score >= self.threshold,
        };
        if is_better && !self.polygon.has_corner(contact.position) {
            self.threshold = score;
            self.found = Some(contact);
        }
    }
}

/// Finds out whether a contact is off the plane through the deepest one.
pub(super) struct OffPlane<'p, const N: usize> {
    polygon: &'p Polygon<N>,
    pub(super) found: bool,
}

impl<'p, const N: usize> OffPlane<'p, N> {
    pub(super) fn new(polygon: &'p Polygon<N>) -> Self {
        Self {
            polygon,
            found: false,
        }
    }
}

impl<const N: usize> Collector for OffPlane<'_, N> {
    const BEST_FIRST: bool = false;

    #[inline(always)]
    fn penetration_threshold(&self) -> f32 {
        self.polygon.penetration_threshold
    }

    #[inline(always)]
    fn add(&mut self, found: &TestedPoints<'_>) -> bool {
        let off_plane = self.polygon.off_plane(found.positions, found.penetrations);
        self.found = (found.contact_mask & off_plane).any();
        !self.found
    }
}
