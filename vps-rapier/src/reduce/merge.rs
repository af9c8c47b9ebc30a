//! Contacts that were refined to the same deepest point.

use vps_core::Observer;

use super::parameters::WARM_START_COSINE;
use crate::query::event::{ContactEvent, ContactObserver, PairEvent};
use crate::query::pair_contact::PairContact;

/// Drops contacts of shells that lie less than `distance` metres from a deeper contact with a similar
/// normal, or from an earlier one as deep.
pub(super) fn merge(
    contacts: &mut Vec<PairContact>,
    distance: f32,
    observer: &ContactObserver<'_, impl Observer<PairEvent>>,
) {
    let is_same = |a: &PairContact, b: &PairContact| {
        a.points[0].distance(b.points[0]) < distance
            && a.normals[0].dot(b.normals[0]) > WARM_START_COSINE
    };
    let mut i = 0;
    while i < contacts.len() {
        let contact = contacts[i];
        let is_merged = contact.shell_normal.is_some()
            && contacts.iter().enumerate().any(|(j, other)| {
                let is_deeper = other.penetration > contact.penetration
                    || other.penetration == contact.penetration && j < i;
                j != i && is_deeper && is_same(&contact, other)
            });
        if is_merged {
            observer.observe(&contact, ContactEvent::Merged);
            contacts.remove(i);
        } else {
            i += 1;
        }
    }
}
