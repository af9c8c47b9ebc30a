//! The choice of a few contacts.

use vps_core::{Approach, Contact, ContactManifold, Event, Fate, Observer, Vec3};

use super::normals::is_same_normal;
use super::parameters::MAX_CONTACTS_PER_NORMAL;
use crate::query::event::{ContactEvent, ContactObserver, PairDropReason, PairEvent};
use crate::query::pair_contact::PairContact;

/// Keeps at most `N` contacts: the deepest first, then those that spread over the largest area, seen
/// along the normal of the deepest (section 3.2). `prediction` is the distance up to which they were
/// searched for, and `approach` that of [`vps_core::Query::with_approach`].
pub(super) fn reduce<const N: usize>(
    contacts: &mut Vec<PairContact>,
    prediction: f32,
    approach: Approach,
    observer: &ContactObserver<'_, impl Observer<PairEvent>>,
) {
    if contacts.len() <= 1 {
        return;
    }
    let numbered = (0..).zip(&*contacts).map(|(point_index, c)| Contact {
        point_index,
        position: c.points[0],
        normal: c.normals[0],
        penetration: c.penetration,
    });
    let numbered: Vec<Contact> = numbered.collect();
    let by_depth = |a: &Contact, b: &Contact| {
        let order = a.penetration.total_cmp(&b.penetration);
        order.then(b.point_index.cmp(&a.point_index))
    };
    let Some(deepest) = numbered.iter().copied().max_by(by_depth) else {
        return;
    };
    let selected = ContactManifold::<N>::reduce_observed(
        &numbered,
        deepest.normal,
        prediction,
        approach,
        &FateObserver { contacts, observer },
    );
    let selected = selected.contacts().iter();
    *contacts = selected.map(|c| contacts[c.point_index as usize]).collect();
}

/// Tells of the contacts that reduction does not keep, given by their index.
struct FateObserver<'o, O> {
    contacts: &'o [PairContact],
    observer: &'o ContactObserver<'o, O>,
}

impl<O: Observer<PairEvent>> Observer for FateObserver<'_, O> {
    const IS_ACTIVE: bool = O::IS_ACTIVE;

    fn observe(&self, event: Event) {
        let Event::ContactReduced { contact, fate } = event else {
            return;
        };
        let event = match fate {
            Fate::Kept { .. } => return,
            Fate::Merged { .. } => ContactEvent::Merged,
            Fate::Dropped(reason) => ContactEvent::Dropped(PairDropReason::Reduced(reason)),
        };
        let contact = &self.contacts[contact.point_index as usize];
        self.observer.observe(contact, event);
    }
}

/// Keeps the first [`MAX_CONTACTS_PER_NORMAL`] contacts of each normal.
pub(super) fn limit_per_normal(
    contacts: &mut Vec<PairContact>,
    observer: &ContactObserver<'_, impl Observer<PairEvent>>,
) {
    let mut groups: Vec<(Vec3, usize)> = Vec::with_capacity(contacts.len());
    contacts.retain(|contact| {
        let normal = contact.normals[0];
        let Some((_, count)) = groups.iter_mut().find(|(n, _)| is_same_normal(*n, normal)) else {
            groups.push((normal, 1));
            return true;
        };
        *count += 1;
        let is_kept = *count <= MAX_CONTACTS_PER_NORMAL;
        if !is_kept {
            observer.observe(contact, ContactEvent::Dropped(PairDropReason::NormalLimit));
        }
        is_kept
    });
}
