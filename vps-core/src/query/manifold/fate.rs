//! The fates of contacts, for observers.

use super::ContactManifold;
use super::polygon::Polygon;
use crate::query::contact::Contact;
use crate::query::observer::{DropReason, Fate};

/// A reduction that has ended.
pub(super) struct EndedReduction<'r, const N: usize> {
    pub(super) manifold: &'r ContactManifold<N>,
    pub(super) polygon: &'r Polygon<N>,
    /// The lowest penetration of contacts of sufficient weight, in metres.
    pub(super) sufficient_penetration: f32,
    /// The number of contacts at which it ends.
    pub(super) max_contacts: usize,
    /// Whether contacts of low weight were considered.
    pub(super) is_filled_up: bool,
}

impl<const N: usize> EndedReduction<'_, N> {
    pub(super) fn fate(&self, contact: &Contact) -> Fate {
        let rank_of = |is_it: &dyn Fn(&Contact) -> bool| {
            let rank = self.manifold.contacts().iter().position(is_it)?;
            Some(rank as u32)
        };
        if let Some(rank) = rank_of(&|kept| kept.point_index == contact.point_index) {
            return Fate::Kept { rank };
        }
        if let Some(rank) = rank_of(&|kept| kept.position == contact.position) {
            return Fate::Merged { rank };
        }
        let is_full = self.manifold.len == self.max_contacts;
        let all_were_considered = self.is_filled_up && !is_full;
        let has_low_weight = contact.penetration < self.sufficient_penetration;
        Fate::Dropped(if has_low_weight && !all_were_considered {
            DropReason::LowWeight
        } else if !is_full || self.polygon.score(contact).is_none() {
            DropReason::NoArea
        } else if self.max_contacts < N && !self.is_filled_up {
            DropReason::Planar
        } else {
            DropReason::Full
        })
    }
}
