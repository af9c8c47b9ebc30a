//! Collectors of contacts: all of them, whether there is one, the deepest.

use wide::f32x4;

use crate::query::contact::Contact;
use crate::query::search::{Found, Goal};

/// All contacts, in order.
pub(crate) struct All<V> {
    margin: f32,
    visit: V,
}

impl<V: FnMut(Contact)> All<V> {
    pub(crate) fn new(margin: f32, visit: V) -> Self {
        Self { margin, visit }
    }
}

impl<V: FnMut(Contact)> Goal for All<V> {
    const BEST_FIRST: bool = false;
    const ALL: bool = true;

    #[inline(always)]
    fn least_penetration(&self) -> f32 {
        -self.margin
    }

    #[inline(always)]
    fn offer(&mut self, found: &Found<'_>) -> bool {
        found.each().for_each(&mut self.visit);
        true
    }
}

/// Whether there is a contact.
pub(super) struct Any {
    pub(super) margin: f32,
    pub(super) found: bool,
}

impl Goal for Any {
    const BEST_FIRST: bool = true;

    #[inline(always)]
    fn least_penetration(&self) -> f32 {
        -self.margin
    }

    #[inline(always)]
    fn offer(&mut self, _found: &Found<'_>) -> bool {
        self.found = true;
        false
    }
}

/// The deepest contact.
pub(crate) struct Deepest {
    /// Its penetration; that of the shallowest there may be as long as none is found.
    pub(crate) least: f32,
    pub(crate) found: Option<Contact>,
}

impl Deepest {
    pub(crate) fn new(margin: f32) -> Self {
        Self {
            least: -margin,
            found: None,
        }
    }
}

impl Goal for Deepest {
    const BEST_FIRST: bool = true;

    #[inline(always)]
    fn least_penetration(&self) -> f32 {
        self.least
    }

    #[inline(always)]
    fn offer(&mut self, found: &Found<'_>) -> bool {
        let deep = found.counts & found.penetrations.simd_ge(f32x4::splat(self.least));
        for contact in found.each_in(deep) {
            if contact.is_deeper_than(self.found.as_ref()) {
                self.least = contact.penetration;
                self.found = Some(contact);
            }
        }
        true
    }
}
