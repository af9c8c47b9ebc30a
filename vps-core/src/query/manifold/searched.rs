//! Contacts found in a tree, as far as they matter.

use glamx::Vec3;

use super::ContactManifold;
use super::buffer::Near;
use super::collectors::{Bent, Spread};
use super::polygon::Polygon;
use super::source::Source;
use super::weighting::Closeness;
use crate::field::DistanceField;
use crate::query::contact::Contact;
use crate::query::posed::Query;
use crate::query::search::TOP;
use crate::query::work::CountWork;
use crate::simd::multiversion::dispatch;

/// The contacts of a query, and what is known of them.
struct Searched<'q, 't, F: ?Sized, W> {
    query: &'q Query<'t, F, W>,
    near: Near,
}

impl<F: DistanceField + ?Sized, W: CountWork> Query<'_, F, W> {
    /// The manifold of the contact set, its area seen along the field's normal at the deepest
    /// point: that of [`ContactManifold::spread`], but without looking at all contacts.
    ///
    /// One search finds the deepest contact and those that count enough, and if these are too few a
    /// second one those that count a little; what counts less than them, or does not fit on the
    /// stack, is searched for contact by contact, as far as it could be better.
    pub fn manifold<const N: usize>(&self) -> ContactManifold<N> {
        // Most bodies of a scene are apart; for them not even a place to keep contacts is made.
        if !self.may_touch() {
            return ContactManifold::EMPTY;
        }
        let closeness = Closeness {
            margin: self.margin,
            motion: self.motion,
        };
        let mut near = Near::new(closeness);
        self.find_from_hint(&mut near);
        near.drop_shallow();
        let deepest = near.deepest.found;
        let along = |deepest: &Contact| {
            let at = self.rotation * deepest.position + self.translation;
            let inward = self.rotation.transpose() * self.field.inward_direction(at);
            if inward == Vec3::ZERO {
                -deepest.normal
            } else {
                inward
            }
        };
        let mut source = Searched { query: self, near };
        ContactManifold::pick(deepest, along, closeness, &mut source)
    }
}

impl<F, W, const N: usize> Source<N> for Searched<'_, '_, F, W>
where
    F: DistanceField + ?Sized,
    W: CountWork,
{
    fn best(&mut self, polygon: &Polygon<N>) -> Option<Contact> {
        let near = &mut self.near;
        if polygon.least < near.least && !near.is_full && !near.has_reached {
            near.reach_down();
            dispatch(
                #[inline(always)]
                || self.query.search(TOP, near),
            );
        }
        let mut spread = Spread {
            polygon,
            below: f32::INFINITY,
            least: f32::MIN_POSITIVE,
            found: None,
        };
        if !near.is_full {
            dispatch(
                #[inline(always)]
                || near.offer_to(self.query.tree, &mut spread),
            );
            if near.least <= polygon.least {
                return spread.found;
            }
            spread.below = near.least;
        }
        self.query.find(spread).found
    }

    fn is_bent(&self, polygon: &Polygon<N>) -> bool {
        if self.near.is_full {
            return self.query.find(Bent::new(polygon)).found;
        }
        let mut kept = self.near.kept[..self.near.len].iter();
        kept.any(|group| {
            let positions = group.positions(self.query.tree);
            polygon.bent(positions, group.penetrations()).any()
        })
    }
}
