//! What happens to the contacts of a pair, for observers.

use vps_core::{Event, Observer, Vec3};

use super::pair_contact::PairContact;

/// An event while the contacts of a pair are found and reduced: see
/// [`VpsDispatcher::observe_contact_manifolds`](crate::VpsDispatcher::observe_contact_manifolds).
#[derive(Clone, Copy, Debug)]
pub enum PairEvent {
    /// An event of the query of a pointshell.
    ShellQuery {
        /// Whether the shell is that of the first shape.
        shell_is_first: bool,
        /// What the query does. Positions are in the frame of the shell.
        event: Event,
    },
    /// Something happens to a contact. First it is found, and in the end it is merged, dropped or kept.
    Contact {
        /// The contact as it was before.
        contact: PairContact,
        /// Whether it is a contact of the step before, evaluated anew in the present pose. Of these, those
        /// that are neither merged nor over the limit of a normal are all kept in the end, or none is. A point may have both a previous contact and a
        /// new one.
        is_previous: bool,
        /// What happens to it.
        event: ContactEvent,
    },
}

/// What happens to a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ContactEvent {
    /// A shell or a sampled edge has it, or it is evaluated anew.
    Found,
    /// It lies where another contact does: exactly where one lies that reduction keeps, or refined to the
    /// same deepest point of a surface.
    Merged,
    /// Its normal changes.
    NormalTurned {
        /// The new unit normal out of the first shape, in its frame.
        normal: Vec3,
        /// Why.
        reason: TurnReason,
    },
    /// The engine does not get it.
    Dropped(PairDropReason),
    /// The engine gets it.
    Kept,
}

/// Why the normal of a contact is turned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TurnReason {
    /// Field and shell disagree: one of the two has an edge there. The direction between their normals is
    /// taken that the contacts agree on.
    Resolved,
    /// The shapes are deep in each other and their contacts push against each other: all get the
    /// direction of the total push.
    DeepPenetration,
}

/// Why an engine does not get a contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PairDropReason {
    /// Contacts of several shells or of edges were reduced together.
    Reduced(vps_core::DropReason),
    /// Four contacts with the same normal come before it.
    NormalLimit,
    /// The contacts of the step before are as good as the new ones, and stay.
    PreviousPersist,
    /// As a contact of the step before: they are fewer, shallower or closer together than the new ones.
    PreviousReplaced,
    /// The shapes are deep in each other, and it pushes against the direction of the total push.
    Opposed,
}

/// Hands the events of the query of a shell on to the observer of a pair.
pub(crate) struct ShellObserver<'o, O> {
    pub(crate) observer: &'o O,
    pub(crate) shell_is_first: bool,
}

impl<O: Observer<PairEvent>> Observer for ShellObserver<'_, O> {
    const IS_ACTIVE: bool = O::IS_ACTIVE;

    fn observe(&self, event: Event) {
        self.observer.observe(PairEvent::ShellQuery {
            shell_is_first: self.shell_is_first,
            event,
        });
    }
}

/// Tells the observer of a pair what happens to its new contacts or to its previous ones.
pub(crate) struct ContactObserver<'o, O> {
    pub(crate) observer: &'o O,
    pub(crate) is_previous: bool,
}

impl<O: Observer<PairEvent>> ContactObserver<'_, O> {
    pub(crate) fn observe(&self, contact: &PairContact, event: ContactEvent) {
        if O::IS_ACTIVE {
            self.observer.observe(PairEvent::Contact {
                contact: *contact,
                is_previous: self.is_previous,
                event,
            });
        }
    }

    pub(crate) fn observe_all(&self, contacts: &[PairContact], event: ContactEvent) {
        if O::IS_ACTIVE {
            contacts
                .iter()
                .for_each(|contact| self.observe(contact, event));
        }
    }

    /// Tells of a new normal of a contact, unless it is the present one.
    pub(crate) fn observe_turn(&self, contact: &PairContact, normal: Vec3, reason: TurnReason) {
        if O::IS_ACTIVE && contact.normals[0] != normal {
            self.observe(contact, ContactEvent::NormalTurned { normal, reason });
        }
    }
}
