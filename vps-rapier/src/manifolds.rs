//! From the contacts of a pair to manifolds of parry, which an engine recognises in the next step.

use rapier3d::math::{Pose, Real};
use rapier3d::parry::query::{ContactManifold, TrackedContact};
use vps_core::{Approach, Observer, Pose3, Vec3};

use crate::precision::{core_pose, core_real, core_vector, real, vector};
use crate::query::event::PairEvent;
use crate::query::pair::Pair;
use crate::query::pair_contact::PairContact;
use crate::reduce::persistence::{ContactKey, match_previous};
use crate::reduce::{Manifolds, contacts, is_same_normal};
use crate::warnings::warn_if_predicted_far;

/// Finds the contacts of a pair up to `prediction` metres away and replaces its manifolds by them. The
/// data an engine keeps stays with the ids of contacts, and with the index of manifolds.
pub(crate) fn update_manifolds<M: Default + Clone, C: Default + Copy>(
    pair: &Pair<'_>,
    pos12: &Pose,
    prediction: Real,
    kind: Manifolds,
    manifolds: &mut Vec<ContactManifold<M, C>>,
    observer: &impl Observer<PairEvent>,
) {
    let (pos12, prediction) = (&core_pose(pos12), core_real(prediction));
    let mut old = std::mem::take(manifolds);
    let previous = old.iter().flat_map(|m| &m.points);
    let previous: Vec<_> = previous.map(|c| [c.fid1, c.fid2]).collect();
    let approach = old
        .first()
        .map_or(Approach::Unknown, |first| approach(first, pos12));
    if let Approach::Moved(motion) = approach {
        warn_if_predicted_far(prediction, pair.size(), motion);
    }
    let contacts = contacts(pair, pos12, prediction, approach, kind, &previous, observer);
    let keys: Vec<_> = contacts.iter().map(ContactKey::of_contact).collect();
    let matched = match_previous(&keys, &old);
    for (contact, data) in contacts.iter().zip(matched) {
        let tracked = tracked_contact(contact, data);
        let normal = contact.normals[0];
        let same = match kind {
            Manifolds::Reduced => manifolds.iter_mut().find(|m| has_normal(m, normal)),
            Manifolds::Segments(_) => None,
        };
        if let Some(manifold) = same {
            manifold.points.push(tracked);
            continue;
        }
        let mut manifold = ContactManifold::<M, C>::new();
        if let Some(old) = old.get_mut(manifolds.len()) {
            manifold.data = old.data.clone();
        }
        [manifold.local_n1, manifold.local_n2] = contact.normals.map(vector);
        manifold.points.push(tracked);
        manifolds.push(manifold);
    }
}

/// How far the shapes have moved towards each other or apart since the contacts of a manifold were
/// found: the mean of its contacts. Unknown without contacts: the shapes were further apart than
/// contacts are searched for.
fn approach<M, C>(manifold: &ContactManifold<M, C>, pos12: &Pose3) -> Approach {
    let normal = core_vector(manifold.local_n1);
    let moved = |contact: &TrackedContact<C>| {
        let on_second = pos12.transform_point(core_vector(contact.local_p2));
        (on_second - core_vector(contact.local_p1)).dot(normal) - core_real(contact.dist)
    };
    let sum: f32 = manifold.points.iter().map(moved).sum();
    match manifold.points.len() {
        0 => Approach::Unknown,
        count => Approach::Moved((sum / count as f32).abs()),
    }
}

fn has_normal<M, C>(manifold: &ContactManifold<M, C>, normal: Vec3) -> bool {
    is_same_normal(core_vector(manifold.local_n1), normal)
}

fn tracked_contact<C: Default + Copy>(contact: &PairContact, data: Option<C>) -> TrackedContact<C> {
    let [point1, point2] = contact.points.map(vector);
    let [id1, id2] = contact.ids;
    let dist = real(-contact.penetration);
    let mut tracked = TrackedContact::new(point1, point2, id1, id2, dist);
    tracked.data = data.unwrap_or_default();
    tracked
}

/// Gives new manifolds the data an engine keeps with the contacts of old ones.
pub(crate) fn warm_start<M, C: Copy>(
    manifolds: &mut [ContactManifold<M, C>],
    old: &[ContactManifold<M, C>],
) {
    let new = manifolds
        .iter()
        .flat_map(|m| m.points.iter().map(move |p| ContactKey::of_tracked(m, p)));
    let matched = match_previous(&new.collect::<Vec<_>>(), old);
    let points = manifolds.iter_mut().flat_map(|m| &mut m.points);
    for (point, data) in points.zip(matched) {
        if let Some(data) = data {
            point.data = data;
        }
    }
}
