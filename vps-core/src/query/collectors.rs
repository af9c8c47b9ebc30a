//! The collectors of all contacts, of any contact, and of the deepest one.

use wide::f32x4;

use crate::query::contact::Contact;
use crate::query::search::{Collector, Found};

/// Visits all contacts, in the order of the points.
pub(crate) struct AllContacts<V> {
    margin: f32,
    visit: V,
}

impl<V: FnMut(Contact)> AllContacts<V> {
    pub(crate) fn new(margin: f32, visit: V) -> Self {
        Self { margin, visit }
    }
}

impl<V: FnMut(Contact)> Collector for AllContacts<V> {
    const BEST_FIRST: bool = false;
    const COLLECTS_ALL: bool = true;

    #[inline(always)]
    fn penetration_threshold(&self) -> f32 {
        -self.margin
    }

    #[inline(always)]
    fn add(&mut self, found: &Found<'_>) -> bool {
        found.contacts().for_each(&mut self.visit);
        true
    }
}

/// Finds out whether there is a contact.
pub(super) struct AnyContact {
    pub(super) margin: f32,
    pub(super) found: bool,
}

impl Collector for AnyContact {
    const BEST_FIRST: bool = true;

    #[inline(always)]
    fn penetration_threshold(&self) -> f32 {
        -self.margin
    }

    #[inline(always)]
    fn add(&mut self, _found: &Found<'_>) -> bool {
        self.found = true;
        false
    }
}

/// Keeps the deepest contact, the first of equally deep ones.
pub(crate) struct DeepestContact {
    /// The penetration of the deepest contact so far, −margin before the first one; in metres.
    pub(crate) threshold: f32,
    pub(crate) found: Option<Contact>,
}

impl DeepestContact {
    pub(crate) fn new(margin: f32) -> Self {
        Self {
            threshold: -margin,
            found: None,
        }
    }
}

impl Collector for DeepestContact {
    const BEST_FIRST: bool = true;

    #[inline(always)]
    fn penetration_threshold(&self) -> f32 {
        self.threshold
    }

    #[inline(always)]
    fn add(&mut self, found: &Found<'_>) -> bool {
        let deep = found.contact_mask & found.penetrations.simd_ge(f32x4::splat(self.threshold));
        for contact in found.contacts_in(deep) {
            if contact.is_deeper_than(self.found.as_ref()) {
                self.threshold = contact.penetration;
                self.found = Some(contact);
            }
        }
        true
    }
}
