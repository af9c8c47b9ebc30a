//! The sources of candidates: a list, and the trait that a search implements as well.

use wide::f32x4;

use super::polygon::Polygon;
use crate::query::contact::Contact;
use crate::simd::Vectors;

/// Candidates for a manifold.
pub(super) trait CandidateSource<const N: usize> {
    /// The candidate with the highest score for a polygon.
    fn best(&mut self, polygon: &Polygon<N>) -> Option<Contact>;

    /// Whether the field is curved: a candidate of sufficient weight is off the plane through the
    /// deepest one.
    fn is_curved(&self, polygon: &Polygon<N>) -> bool;

    /// Calls `visit` with all contacts.
    fn for_each(&self, visit: impl FnMut(Contact));
}

/// A list of all contacts.
pub(super) struct ListedCandidates<'c>(pub(super) &'c [Contact]);

impl<const N: usize> CandidateSource<N> for ListedCandidates<'_> {
    fn best(&mut self, polygon: &Polygon<N>) -> Option<Contact> {
        best(self.0, |c| polygon.score(c))
    }

    fn is_curved(&self, polygon: &Polygon<N>) -> bool {
        self.0.iter().any(|c| {
            let position = Vectors::splat(c.position);
            polygon
                .off_plane(position, f32x4::splat(c.penetration))
                .any()
        })
    }

    fn for_each(&self, visit: impl FnMut(Contact)) {
        self.0.iter().copied().for_each(visit);
    }
}

/// The first contact with the largest score, among those with a score.
pub(super) fn best(
    contacts: &[Contact],
    score: impl Fn(&Contact) -> Option<f32>,
) -> Option<Contact> {
    let mut best: Option<(f32, &Contact)> = None;
    for contact in contacts {
        if let Some(score) = score(contact)
            && best.is_none_or(|(most, _)| score > most)
        {
            best = Some((score, contact));
        }
    }
    best.map(|(_, contact)| *contact)
}
