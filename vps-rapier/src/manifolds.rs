//! From the contacts of a pair to manifolds of parry that an engine knows again the next step.

use rapier3d::parry::query::{ContactManifold, TrackedContact};
use rapier3d::parry::shape::PackedFeatureId;
use vps_core::{Pose3, Vec3};

use crate::Manifolds;
use crate::contact::{PairContact, is_same_normal};
use crate::pair::Pair;
use crate::real::{core_real, core_vector, real, vector};

/// Finds the contacts of a pair up to `margin` metres away and replaces its manifolds by them.
/// What the engine remembers of a contact stays with the same ids, and of a manifold with its place.
pub(crate) fn update_manifolds<M: Default + Clone, C: Default + Copy>(
    pair: &Pair<'_>,
    pos12: &Pose3,
    margin: f32,
    kind: Manifolds,
    manifolds: &mut Vec<ContactManifold<M, C>>,
) {
    let mut old = std::mem::take(manifolds);
    let before = old.iter().flat_map(|m| &m.points);
    let before: Vec<_> = before.map(|c| [c.fid1, c.fid2]).collect();
    let motion = old.first().and_then(|first| motion(first, pos12));
    let contacts = pair.contacts(pos12, margin, motion, kind, &before);
    let new: Vec<_> = contacts.iter().map(Known::of_contact).collect();
    let remembered = remembered(&new, &old);
    for (contact, data) in contacts.iter().zip(remembered) {
        let tracked = tracked(contact, data);
        let normal = contact.normals[0];
        let same = match kind {
            Manifolds::Spread => manifolds.iter_mut().find(|m| fits(m, normal)),
            Manifolds::Segments(_) => None,
        };
        if let Some(manifold) = same {
            manifold.points.push(tracked);
            continue;
        }
        let mut manifold = ContactManifold::<M, C>::new();
        if let Some(before) = old.get_mut(manifolds.len()) {
            manifold.data = before.data.clone();
        }
        [manifold.local_n1, manifold.local_n2] = contact.normals.map(vector);
        manifold.points.push(tracked);
        manifolds.push(manifold);
    }
}

/// How far the shapes moved towards each other or apart since their contacts were found, in metres:
/// the mean of what those of a manifold say. `None` without contacts: then they were further apart
/// than those reach.
fn motion<M, C>(manifold: &ContactManifold<M, C>, pos12: &Pose3) -> Option<f32> {
    let normal = core_vector(manifold.local_n1);
    let moved = |contact: &TrackedContact<C>| {
        let on_second = pos12.transform_point(core_vector(contact.local_p2));
        (on_second - core_vector(contact.local_p1)).dot(normal) - core_real(contact.dist)
    };
    let sum: f32 = manifold.points.iter().map(moved).sum();
    let count = manifold.points.len();
    (count > 0).then(|| (sum / count as f32).abs())
}

fn fits<M, C>(manifold: &ContactManifold<M, C>, normal: Vec3) -> bool {
    is_same_normal(core_vector(manifold.local_n1), normal)
}

fn tracked<C: Default + Copy>(contact: &PairContact, data: Option<C>) -> TrackedContact<C> {
    let [point1, point2] = contact.points.map(vector);
    let [id1, id2] = contact.ids;
    let dist = real(-contact.penetration);
    let mut tracked = TrackedContact::new(point1, point2, id1, id2, dist);
    tracked.data = data.unwrap_or_default();
    tracked
}

/// What a contact is known by in the next step.
struct Known {
    ids: [PackedFeatureId; 2],
    /// On the first shape, in its frame.
    point: Vec3,
    /// Out of the first shape.
    normal: Vec3,
}

impl Known {
    fn of_contact(contact: &PairContact) -> Self {
        Self {
            ids: contact.ids,
            point: contact.points[0],
            normal: contact.normals[0],
        }
    }

    fn of_tracked<M, C>(manifold: &ContactManifold<M, C>, contact: &TrackedContact<C>) -> Self {
        Self {
            ids: [contact.fid1, contact.fid2],
            point: core_vector(contact.local_p1),
            normal: core_vector(manifold.local_n1),
        }
    }
}

/// Gives new manifolds what the engine remembers of old ones.
pub(crate) fn remember<M, C: Copy>(
    manifolds: &mut [ContactManifold<M, C>],
    old: &[ContactManifold<M, C>],
) {
    let new = manifolds
        .iter()
        .flat_map(|m| m.points.iter().map(move |p| Known::of_tracked(m, p)));
    let data = remembered(&new.collect::<Vec<_>>(), old);
    let points = manifolds.iter_mut().flat_map(|m| &mut m.points);
    for (point, data) in points.zip(data) {
        if let Some(data) = data {
            point.data = data;
        }
    }
}

/// What the engine remembers for each contact: that of the same ids, and of those left over that of
/// the closest with much the same normal. So the forces a body rests on are handed on when others of
/// its points take over.
fn remembered<M, C: Copy>(contacts: &[Known], old: &[ContactManifold<M, C>]) -> Vec<Option<C>> {
    let points = old.iter().flat_map(|m| {
        m.points
            .iter()
            .map(move |p| (Known::of_tracked(m, p), p.data))
    });
    let mut left: Vec<_> = points.collect();
    let mut data: Vec<Option<C>> = contacts
        .iter()
        .map(|contact| {
            let at = left
                .iter()
                .position(|(known, _)| known.ids == contact.ids)?;
            Some(left.swap_remove(at).1)
        })
        .collect();
    for (contact, data) in contacts.iter().zip(&mut data) {
        if data.is_some() {
            continue;
        }
        let near = left
            .iter()
            .enumerate()
            .filter(|(_, (known, _))| known.normal.dot(contact.normal) > ALIKE);
        let distance = |known: &Known| known.point.distance(contact.point);
        let near = near.min_by(|(_, (a, _)), (_, (b, _))| distance(a).total_cmp(&distance(b)));
        if let Some((at, _)) = near {
            *data = Some(left.swap_remove(at).1);
        }
    }
    data
}

/// How alike normals are, as a cosine, for one contact to take over from another.
const ALIKE: f32 = 0.9;
