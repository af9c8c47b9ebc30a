//! Where contacts are picked from.

use wide::f32x4;

use super::polygon::Polygon;
use crate::query::contact::Contact;
use crate::simd::Vectors;

/// Contacts to pick from.
pub(super) trait Source<const N: usize> {
    /// The one that adds the most to a polygon.
    fn best(&mut self, polygon: &Polygon<N>) -> Option<Contact>;

    /// Whether one that counts enough is off the plane through the deepest.
    fn is_bent(&self, polygon: &Polygon<N>) -> bool;
}

/// All contacts in a list.
pub(super) struct Listed<'c>(pub(super) &'c [Contact]);

impl<const N: usize> Source<N> for Listed<'_> {
    fn best(&mut self, polygon: &Polygon<N>) -> Option<Contact> {
        best(self.0, |c| polygon.score(c))
    }

    fn is_bent(&self, polygon: &Polygon<N>) -> bool {
        self.0.iter().any(|c| {
            let position = Vectors::splat(c.position);
            polygon.bent(position, f32x4::splat(c.penetration)).any()
        })
    }
}

/// The first contact with the largest score; those without one are left out.
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
