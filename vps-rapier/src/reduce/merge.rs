//! Contacts that were refined to the same deepest point.

use vps_core::Observer;

use super::parameters::WARM_START_COSINE;
use crate::query::event::{ContactEvent, ContactObserver, PairEvent};
use crate::query::pair_contact::PairContact;

/// Drops contacts of shells less than `distance` metres from a deeper contact that is kept and has a
/// similar normal; of equally deep ones the first is kept. The deepest then comes first, as it does before
/// refinement.
pub(super) fn merge(
    contacts: &mut Vec<PairContact>,
    distance: f32,
    observer: &ContactObserver<'_, impl Observer<PairEvent>>,
) {
    if distance == 0.0 {
        // None is refined, and their order is that of the search.
        return;
    }
    let mut by_depth: Vec<usize> = (0..contacts.len()).collect();
    by_depth.sort_by(|&a, &b| contacts[b].penetration.total_cmp(&contacts[a].penetration));
    let mut kept: Vec<usize> = Vec::with_capacity(contacts.len());
    for i in by_depth {
        let contact = &contacts[i];
        // On the surface of the shell.
        let side = usize::from(!contact.shell_is_first);
        let is_same = |&other: &usize| {
            let other = &contacts[other];
            contact.points[side].distance(other.points[side]) < distance
                && contact.normals[0].dot(other.normals[0]) > WARM_START_COSINE
        };
        if contact.shell_normal.is_some() && kept.iter().any(is_same) {
            observer.observe(contact, ContactEvent::Merged);
        } else {
            kept.push(i);
        }
    }
    let deepest = kept.first().copied();
    kept.sort_unstable();
    if let Some(deepest) = deepest {
        let at = kept.partition_point(|&i| i < deepest);
        kept[..=at].rotate_right(1);
    }
    *contacts = kept.into_iter().map(|i| contacts[i]).collect();
}
