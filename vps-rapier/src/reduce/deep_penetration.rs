//! Recovery from deep penetration.

use vps_core::{Observer, Pose3, Vec3};

use super::parameters::DEEP_PENETRATION;
use crate::query::event::{ContactEvent, ContactObserver, PairDropReason, PairEvent, TurnReason};
use crate::query::pair::Pair;
use crate::query::pair_contact::{PairContact, max_penetration};

/// Turns the contacts of a pair to the direction all its points push in together, where the nearest
/// surface may not be the way out: they are deep and push against each other.
pub(super) fn recover_deep_penetration(
    pair: &Pair<'_>,
    contacts: &mut Vec<PairContact>,
    pos12: &Pose3,
    observer: &ContactObserver<'_, impl Observer<PairEvent>>,
) {
    let is_deep = max_penetration(contacts) > DEEP_PENETRATION * pair.size_in_pose(pos12);
    if is_deep && are_opposed(contacts) {
        let push = pair
            .shells(pos12)
            .map(|shell| shell.push_on_first(pos12))
            .sum::<Vec3>();
        if push != Vec3::ZERO {
            turn_to(contacts, -push.normalize(), pos12, observer);
        }
    }
}

/// Whether some of the contacts push against each other.
fn are_opposed(contacts: &[PairContact]) -> bool {
    let normals = || contacts.iter().map(|c| c.normals[0]);
    normals().any(|a| normals().any(|b| a.dot(b) < 0.0))
}

/// Turns contacts to one normal out of the first shape and drops those that push against it, unless all
/// do.
fn turn_to(
    contacts: &mut Vec<PairContact>,
    normal: Vec3,
    pos12: &Pose3,
    observer: &ContactObserver<'_, impl Observer<PairEvent>>,
) {
    if contacts.iter().all(|c| c.normals[0].dot(normal) <= 0.0) {
        return;
    }
    contacts.retain(|contact| {
        let is_kept = contact.normals[0].dot(normal) > 0.0;
        if !is_kept {
            observer.observe(contact, ContactEvent::Dropped(PairDropReason::Opposed));
        }
        is_kept
    });
    for contact in contacts {
        observer.observe_turn(contact, normal, TurnReason::DeepPenetration);
        contact.set_normal(normal, pos12);
    }
}
