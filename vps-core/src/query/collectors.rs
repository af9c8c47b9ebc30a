//! The interface of collectors to the search, and the collectors of all contacts, of any contact, and
//! of the deepest one.

use wide::f32x4;

use crate::field::Discs;
use crate::query::contact::Contact;
use crate::query::observer::{Event, Observer, Score};
use crate::shell::PointSphereTree;
use crate::simd::{Vectors, lanes_in};

/// Takes the contacts of a search whose score is at least [`threshold`](Self::threshold), which prunes
/// the tree.
pub(crate) trait Collector {
    /// Whether sibling clusters are visited by descending score. Otherwise they are visited in order,
    /// and contacts come in the order of the points.
    const BEST_FIRST: bool;

    /// Whether all contacts are collected. The children of a cluster that probably lies in the
    /// field as a whole are then visited without bounding them.
    const COLLECTS_ALL: bool = false;

    /// Whether [`add`](Self::add) needs the gradient of the field at each contact.
    const NEEDS_GRADIENT: bool = false;

    /// What a score is.
    const SCORE: Score = Score::Penetration;

    /// Upper bounds on the scores of the contacts in discs (in the shell frame), given upper bounds on
    /// their penetrations.
    fn score_bounds(&self, discs: &Discs, penetrations: f32x4) -> f32x4 {
        let _ = discs;
        penetrations
    }

    /// Early-out value: the lowest score that matters. It may rise as contacts are added. A score is
    /// the penetration unless [`score_bounds`](Self::score_bounds) is overridden.
    fn threshold(&self) -> f32 {
        self.penetration_threshold()
    }

    /// The lowest penetration that matters, in metres.
    fn penetration_threshold(&self) -> f32;

    /// Takes contacts with at least that penetration. False ends the search.
    fn add(&mut self, found: &TestedPoints<'_>) -> bool;
}

/// Points that were tested together.
pub(crate) struct TestedPoints<'t> {
    pub(super) tree: &'t PointSphereTree<'t>,
    /// Index of the first point.
    pub(crate) first: u32,
    /// The lanes that hold contacts.
    pub(crate) contact_mask: f32x4,
    /// Positions in metres, in the shell frame.
    pub(crate) positions: Vectors,
    /// Unit inward normals of the shell, in the shell frame.
    pub(crate) inward: Vectors,
    /// In metres, positive inside.
    pub(crate) penetrations: f32x4,
    /// −∇V in the shell frame; zero unless the collector needs gradients.
    pub(crate) outward: Vectors,
}

impl TestedPoints<'_> {
    /// The contacts, in the order of the points.
    #[inline(always)]
    pub(crate) fn contacts(&self) -> impl Iterator<Item = Contact> {
        self.contacts_in(self.contact_mask)
    }

    /// The contacts of the given lanes.
    #[inline(always)]
    pub(crate) fn contacts_in(&self, lanes: f32x4) -> impl Iterator<Item = Contact> {
        lanes_in(lanes).map(
            #[inline(always)]
            |lane| self.contact(lane),
        )
    }

    /// Tells an observer of the points before `end`.
    pub(super) fn observe(&self, end: u32, threshold: f32, observer: &impl Observer) {
        let contacts = self.contact_mask.to_bitmask();
        for (lane, penetration) in (0..end - self.first).zip(self.penetrations.to_array()) {
            observer.observe(Event::PointTested {
                point_index: self.first + lane,
                penetration,
                threshold,
                is_kept: contacts >> lane & 1 == 1,
            });
        }
    }

    #[inline(always)]
    pub(crate) fn contact(&self, lane: usize) -> Contact {
        let penetration = self.penetrations.to_array()[lane];
        Contact::of(self.tree, self.first + lane as u32, penetration)
    }
}

/// Visits all contacts, in the order of the points.
pub(crate) struct AllContacts<V> {
    prediction: f32,
    visit: V,
}

impl<V: FnMut(Contact)> AllContacts<V> {
    pub(crate) fn new(prediction: f32, visit: V) -> Self {
        Self { prediction, visit }
    }
}

impl<V: FnMut(Contact)> Collector for AllContacts<V> {
    const BEST_FIRST: bool = false;
    const COLLECTS_ALL: bool = true;

    #[inline(always)]
    fn penetration_threshold(&self) -> f32 {
        -self.prediction
    }

    #[inline(always)]
    fn add(&mut self, found: &TestedPoints<'_>) -> bool {
        found.contacts().for_each(&mut self.visit);
        true
    }
}

/// Finds out whether there is a contact.
pub(super) struct AnyContact {
    pub(super) prediction: f32,
    pub(super) found: bool,
}

impl Collector for AnyContact {
    const BEST_FIRST: bool = true;

    #[inline(always)]
    fn penetration_threshold(&self) -> f32 {
        -self.prediction
    }

    #[inline(always)]
    fn add(&mut self, _found: &TestedPoints<'_>) -> bool {
        self.found = true;
        false
    }
}

/// Keeps the deepest contact, the first of equally deep ones.
pub(crate) struct DeepestContact {
    /// The penetration of the deepest contact so far, −prediction before the first one; in metres.
    pub(crate) threshold: f32,
    pub(crate) found: Option<Contact>,
}

impl DeepestContact {
    pub(crate) fn new(prediction: f32) -> Self {
        Self {
            threshold: -prediction,
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
    fn add(&mut self, found: &TestedPoints<'_>) -> bool {
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
