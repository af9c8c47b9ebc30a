//! What is searched for: the contact that adds the most, and one off the plane.

use wide::f32x4;

use super::polygon::Polygon;
use crate::field::Discs;
use crate::query::contact::Contact;
use crate::query::search::{Found, Goal};
use crate::simd::lanes_in;

/// The contact that adds the most to a polygon.
pub(super) struct Spread<'p, const N: usize> {
    pub(super) polygon: &'p Polygon<N>,
    /// Contacts that are deeper have been considered.
    pub(super) below: f32,
    pub(super) least: f32,
    pub(super) found: Option<Contact>,
}

impl<const N: usize> Goal for Spread<'_, N> {
    const BEST_FIRST: bool = true;

    #[inline(always)]
    fn bounds(&self, discs: &Discs, penetrations: f32x4) -> f32x4 {
        let left = penetrations.fast_min(f32x4::splat(self.below));
        self.polygon.bounds(discs, left)
    }

    #[inline(always)]
    fn least(&self) -> f32 {
        self.least
    }

    #[inline(always)]
    fn least_penetration(&self) -> f32 {
        self.polygon.least
    }

    #[inline(always)]
    fn offer(&mut self, found: &Found<'_>) -> bool {
        let scores = self.polygon.scores(found.positions, found.penetrations);
        for lane in lanes_in(found.counts & scores.simd_ge(f32x4::splat(self.least))) {
            self.consider(found.contact(lane), scores.to_array()[lane]);
        }
        true
    }
}

impl<const N: usize> Spread<'_, N> {
    /// Takes a contact if it is better than what was found; `score` is without its normal.
    pub(super) fn consider(&mut self, contact: Contact, score: f32) {
        let score = score * self.polygon.facing(contact.normal);
        let is_better = match &self.found {
            Some(best) => score > self.least || score == self.least && contact.point < best.point,
            None => score >= self.least,
        };
        if is_better && !self.polygon.has_corner(contact.position) {
            self.least = score;
            self.found = Some(contact);
        }
    }
}

/// Any contact that is off the plane through the deepest.
pub(super) struct Bent<'p, const N: usize> {
    polygon: &'p Polygon<N>,
    pub(super) found: bool,
}

impl<'p, const N: usize> Bent<'p, N> {
    pub(super) fn new(polygon: &'p Polygon<N>) -> Self {
        Self {
            polygon,
            found: false,
        }
    }
}

impl<const N: usize> Goal for Bent<'_, N> {
    const BEST_FIRST: bool = false;

    #[inline(always)]
    fn least_penetration(&self) -> f32 {
        self.polygon.least
    }

    #[inline(always)]
    fn offer(&mut self, found: &Found<'_>) -> bool {
        let bent = self.polygon.bent(found.positions, found.penetrations);
        self.found = (found.counts & bent).any();
        !self.found
    }
}
