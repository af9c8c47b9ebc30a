//! From the contacts of a pair to manifolds of parry that an engine knows again the next step.

use rapier3d::parry::query::{ContactManifold, TrackedContact};
use vps_core::{Pose3, Vec3};

use crate::Manifolds;
use crate::contact::{PairContact, is_same_normal};
use crate::pair::Pair;
use crate::real::{core_vector, real, vector};

/// Finds the contacts of a pair up to `margin` metres away and replaces its manifolds by them;
/// `motion` is how far the shapes moved against each other since the step before.
/// What the engine remembers of a contact stays with the same ids, and of a manifold with its place.
pub(crate) fn update_manifolds<M: Default + Clone, C: Default + Copy>(
    pair: &Pair<'_>,
    pos12: &Pose3,
    margin: f32,
    motion: Option<f32>,
    kind: Manifolds,
    manifolds: &mut Vec<ContactManifold<M, C>>,
) {
    let mut old = std::mem::take(manifolds);
    let before = old.iter().flat_map(|m| &m.points);
    let before: Vec<_> = before.map(|c| [c.fid1, c.fid2]).collect();
    let contacts = pair.contacts(pos12, margin, motion, kind, &before);
    let remembered = remembered(&contacts, &old);
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

/// The normals out of both shapes, each in its frame.
pub(crate) fn normals<M, C>(manifold: &ContactManifold<M, C>) -> [Vec3; 2] {
    [manifold.local_n1, manifold.local_n2].map(core_vector)
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

/// What the engine remembers for each contact: that of the same ids, and of those left over that of
/// the closest with much the same normal. So the forces a body rests on are handed on when others of
/// its points take over.
fn remembered<M, C: Copy>(
    contacts: &[PairContact],
    old: &[ContactManifold<M, C>],
) -> Vec<Option<C>> {
    let normal_of = |m: &ContactManifold<M, C>| core_vector(m.local_n1);
    let points = old
        .iter()
        .flat_map(|m| m.points.iter().map(move |p| (normal_of(m), p)));
    let mut left: Vec<_> = points.collect();
    let mut data: Vec<Option<C>> = contacts
        .iter()
        .map(|contact| {
            let same = |(_, o): &(Vec3, &TrackedContact<C>)| [o.fid1, o.fid2] == contact.ids;
            let at = left.iter().position(same)?;
            Some(left.swap_remove(at).1.data)
        })
        .collect();
    for (contact, data) in contacts.iter().zip(&mut data) {
        if data.is_some() {
            continue;
        }
        let near = left
            .iter()
            .enumerate()
            .filter(|(_, (n, _))| n.dot(contact.normals[0]) > ALIKE);
        let way = |o: &TrackedContact<C>| core_vector(o.local_p1).distance(contact.points[0]);
        let near = near.min_by(|(_, (_, a)), (_, (_, b))| way(a).total_cmp(&way(b)));
        if let Some((at, _)) = near {
            *data = Some(left.swap_remove(at).1.data);
        }
    }
    data
}

/// How alike normals are, as a cosine, for one contact to take over from another.
const ALIKE: f32 = 0.9;
