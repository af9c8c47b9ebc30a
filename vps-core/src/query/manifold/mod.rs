//! Contact reduction: a few contacts that represent the contact set.

mod buffer;
mod collectors;
mod fate;
mod polygon;
mod searched;
mod source;
mod weighting;

use glamx::Vec3;

use self::fate::EndedReduction;
use self::polygon::Polygon;
use self::source::{CandidateSource, ListedCandidates, best};
use self::weighting::{DepthWeighting, SUPPORT_CONTACTS};
use crate::query::approach::Approach;
use crate::query::contact::Contact;
use crate::query::observer::{Event, Observer};

/// At most `N` contacts that represent a contact set (contact reduction): the deepest one first, then
/// those that give the manifold the largest area (section 3.2).
///
/// The area a contact adds is weighted by its depth: the further outside of the solid it lies than the
/// deepest one, the less it counts, with half weight at a hundredth of the prediction distance. The
/// points on which a body rests thus come before points that are further apart but above the
/// ground; without them the body would never come to rest. While a body moves, other points touch
/// the ground in the next step: the distance of half weight is then its motion since the previous
/// query ([`Query::with_approach`](crate::Query::with_approach)). Contacts with less than half the
/// weight of the deepest one only fill up the manifold to four contacts, since the body may tip
/// onto them next.
///
/// More than four contacts are selected only where the field is curved, that is where the
/// penetrations of contacts of sufficient weight differ from those in a half-space: four contacts
/// support a body on a plane, but not in a thread. The weight also decreases with the angle between
/// the normals of a contact and of the deepest one, down to a quarter: points close to an edge come
/// before those on it, whose normals belong to neither side. Of contacts with equal scores the
/// first is selected.
///
/// ```
/// use vps_core::{ContactManifold, HalfSpace, PointSphereTree, Pose3, Query, Vec3};
///
/// // The ends of a peg that stands on the ground, one of them 10 mm too deep.
/// let (low, high) = (Vec3::new(0.0, -0.01, 0.0), Vec3::new(0.0, 0.2, 0.0));
/// let tree = PointSphereTree::flat(&[low, high], &[Vec3::Y, Vec3::NEG_Y], 1e-4)?;
/// let ground = HalfSpace::new(Vec3::Y);
/// let query = Query::new(&tree, &ground, Pose3::IDENTITY);
/// let manifold: ContactManifold<4> = query.manifold();
/// assert_eq!(manifold.contacts().len(), 1);
/// # Ok::<(), vps_core::TreeError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactManifold<const N: usize> {
    contacts: [Contact; N],
    len: usize,
}

impl<const N: usize> ContactManifold<N> {
    const EMPTY: Self = Self {
        contacts: [Contact {
            point_index: 0,
            position: Vec3::ZERO,
            normal: Vec3::ZERO,
            penetration: 0.0,
        }; N],
        len: 0,
    };

    /// Reduces `contacts`, found by a query with a `prediction` in metres and an `approach`. The area is that
    /// of the polygon of the selected points, seen `along` a unit vector in the shell frame: the
    /// direction in which penetration grows at the deepest point. Costs `N` passes.
    ///
    /// [`Query::manifold`](crate::Query::manifold) gives the same without a list of all contacts.
    pub fn reduce(contacts: &[Contact], along: Vec3, prediction: f32, approach: Approach) -> Self {
        Self::reduce_observed(contacts, along, prediction, approach, &())
    }

    /// The same as [`reduce`](Self::reduce) with an observer, which gets an [`Event::ContactReduced`] for
    /// each of the contacts, in their order.
    ///
    /// ```
    /// use std::cell::RefCell;
    /// use vps_core::{Approach, Contact, ContactManifold, DropReason, Event, Fate, Vec3};
    ///
    /// // Three contacts in a row.
    /// let contacts = [(0, 0.0), (1, 1.0), (2, 0.5)].map(|(point_index, x)| Contact {
    ///     point_index,
    ///     position: Vec3::new(x, 0.0, 0.0),
    ///     normal: Vec3::Y,
    ///     penetration: 0.01,
    /// });
    /// let fates = RefCell::new(Vec::new());
    /// let observer = |event| {
    ///     if let Event::ContactReduced { fate, .. } = event {
    ///         fates.borrow_mut().push(fate);
    ///     }
    /// };
    /// let rest = Approach::RESTING;
    /// ContactManifold::<4>::reduce_observed(&contacts, Vec3::Y, 0.1, rest, &observer);
    /// let dropped = Fate::Dropped(DropReason::NoArea);
    /// assert_eq!(fates.into_inner(), [Fate::Kept { rank: 0 }, Fate::Kept { rank: 1 }, dropped]);
    /// ```
    pub fn reduce_observed(
        contacts: &[Contact],
        along: Vec3,
        prediction: f32,
        approach: Approach,
        observer: &impl Observer,
    ) -> Self {
        let weighting = DepthWeighting {
            prediction,
            approach,
        };
        let deepest = best(contacts, |c| Some(c.penetration));
        Self::select(
            deepest,
            |_| along,
            weighting,
            &mut ListedCandidates(contacts),
            observer,
        )
    }

    /// Selects contacts from a source, given the deepest.
    fn select<O: Observer>(
        deepest: Option<Contact>,
        along: impl FnOnce(&Contact) -> Vec3,
        weighting: DepthWeighting,
        source: &mut impl CandidateSource<N>,
        observer: &O,
    ) -> Self {
        let mut manifold = Self::EMPTY;
        if N == 0 {
            return manifold;
        }
        let Some(deepest) = deepest else {
            return manifold;
        };
        let mut polygon = Polygon::new(&deepest, along(&deepest), weighting);
        let sufficient_penetration = polygon.penetration_threshold;
        manifold.push(deepest);
        let mut max_contacts = N.min(SUPPORT_CONTACTS);
        let mut is_filled_up = false;
        while manifold.len < max_contacts {
            let mut selected = source.best(&polygon);
            if selected.is_none() && manifold.len < SUPPORT_CONTACTS && !is_filled_up {
                (polygon.penetration_threshold, is_filled_up) = (-weighting.prediction, true);
                selected = source.best(&polygon);
            }
            let Some(next) = selected else {
                break;
            };
            polygon.insert(next.position);
            manifold.push(next);
            let may_extend =
                manifold.len == SUPPORT_CONTACTS && SUPPORT_CONTACTS < N && !is_filled_up;
            if may_extend && source.is_curved(&polygon) {
                max_contacts = N;
            }
        }
        if O::IS_ACTIVE {
            let ended = EndedReduction {
                manifold: &manifold,
                polygon: &polygon,
                sufficient_penetration,
                max_contacts,
                is_filled_up,
            };
            source.for_each(|contact| {
                let fate = ended.fate(&contact);
                observer.observe(Event::ContactReduced { contact, fate });
            });
        }
        manifold
    }

    /// The selected contacts, deepest first.
    pub fn contacts(&self) -> &[Contact] {
        &self.contacts[..self.len]
    }

    fn push(&mut self, contact: Contact) {
        self.contacts[self.len] = contact;
        self.len += 1;
    }
}

#[cfg(test)]
mod tests {
    use std::vec::Vec;

    use super::*;

    fn contact(point_index: u32, x: f32, z: f32, penetration: f32) -> Contact {
        Contact {
            point_index,
            position: Vec3::new(x, 0.0, z),
            normal: Vec3::Y,
            penetration,
        }
    }

    fn picked<const N: usize>(contacts: &[Contact]) -> Vec<u32> {
        let manifold = ContactManifold::<N>::reduce(contacts, Vec3::Y, 0.1, Approach::RESTING);
        manifold.contacts().iter().map(|c| c.point_index).collect()
    }

    #[test]
    fn the_deepest_comes_first_and_the_corners_follow() {
        // A 5 x 5 grid of contacts, deepest in the middle of one side.
        let contacts: Vec<_> = (0..25)
            .map(|i| {
                let (x, z) = ((i % 5) as f32, (i / 5) as f32);
                contact(i, x, z, if i == 2 { 1.0 } else { 0.5 })
            })
            .collect();
        let mut four = picked::<4>(&contacts);
        assert_eq!(four[0], 2);
        four.sort_unstable();
        // (2, 0) with a far corner, and two more that span the largest quadrilateral.
        assert_eq!(four.len(), 4);
        assert!(four.contains(&20) && four.contains(&24));
        let mut five = picked::<5>(&contacts);
        five.sort_unstable();
        assert_eq!(five, [0, 2, 4, 20, 24]);
    }

    #[test]
    fn a_point_that_touches_comes_before_one_above_it() {
        let mut contacts = std::vec![contact(0, 0.0, 0.0, 0.01), contact(1, 4.0, 0.0, 0.0)];
        // A little further out, where its weight is a third.
        contacts.push(contact(2, 4.5, 0.0, -0.0015));
        assert_eq!(picked::<2>(&contacts), [0, 1]);
        contacts.remove(1);
        assert_eq!(picked::<2>(&contacts), [0, 2]);
        // Where its weight is too low, unless nothing else is left.
        contacts[1].penetration = -0.05;
        assert_eq!(picked::<2>(&contacts), [0, 2]);
        contacts.push(contact(3, 0.0, 0.001, 0.0));
        assert_eq!(picked::<2>(&contacts), [0, 3]);
        assert_eq!(picked::<3>(&contacts), [0, 3, 2]);
    }

    #[test]
    fn a_moving_shell_counts_the_points_it_touches_next() {
        let mut contacts = [
            contact(0, 0.0, 0.0, 0.01),
            contact(1, 4.0, 0.0, 0.0),
            contact(2, 8.0, 0.0, -0.01),
        ];
        let second = |contacts: &[Contact], approach| {
            let manifold = ContactManifold::<2>::reduce(contacts, Vec3::Y, 0.1, approach);
            manifold.contacts()[1].point_index
        };
        assert_eq!(
            [0.0, 0.01, 0.1].map(|m| second(&contacts, Approach::Moved(m))),
            [1, 1, 2]
        );
        // A shell that touches already may have been placed there.
        assert_eq!(second(&contacts, Approach::Unknown), 1);
        for contact in &mut contacts {
            contact.penetration -= 0.04;
        }
        assert_eq!(second(&contacts, Approach::Unknown), 2);
    }

    #[test]
    fn four_contacts_are_enough_on_a_plane() {
        let ground: Vec<_> = (0..100)
            .map(|i| contact(i, (i % 10) as f32, (i / 10) as f32, 0.01))
            .collect();
        assert_eq!(picked::<8>(&ground).len(), 4);
        // A slope is flat as well: penetration grows upwards.
        let slope = ground.iter().map(|c| Contact {
            position: c.position.with_y(0.1 * c.position.x),
            penetration: 0.01 + 0.1 * c.position.x,
            ..*c
        });
        assert_eq!(picked::<8>(&slope.collect::<Vec<_>>()).len(), 4);
        // A wall is not: there penetration stays the same upwards.
        let wall = (0..100).map(|i| Contact {
            position: Vec3::new(-1.0, (i % 10) as f32, (i / 10) as f32),
            ..contact(100 + i, 0.0, 0.0, 0.01)
        });
        let both: Vec<_> = ground.iter().copied().chain(wall).collect();
        assert!(picked::<8>(&both).len() > 4);
        assert_eq!(picked::<4>(&both).len(), 4);
    }

    #[test]
    fn points_that_add_no_area_are_not_selected() {
        let line: Vec<_> = (0..9).map(|i| contact(i, i as f32, 0.0, 0.1)).collect();
        assert_eq!(picked::<4>(&line), [0, 8]);
        assert_eq!(picked::<4>(&[contact(3, 0.0, 0.0, 0.1); 7]), [3]);
        assert_eq!(picked::<4>(&[]), []);
        assert_eq!(picked::<0>(&line), []);
    }
}
