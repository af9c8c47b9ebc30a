//! From the contacts of a pair to manifolds of parry that an engine knows again the next step.

use rapier3d::parry::query::{ContactManifold, TrackedContact};
use vps_core::{Pose3, Vec3};

use crate::Manifolds;
use crate::contact::PairContact;
use crate::pair::Pair;
use crate::real::{core_vector, real, vector};

/// Contacts whose normals differ by less than 5 degrees share a manifold.
const SAME_NORMAL: f32 = 0.996_2;

/// Finds the contacts of a pair up to `prediction` metres away and replaces its manifolds by them.
/// What the engine remembers of a contact stays with the same ids, and of a manifold with its place.
pub(crate) fn update_manifolds<M: Default + Clone, C: Default + Copy>(
    pair: &Pair<'_>,
    pos12: &Pose3,
    prediction: f32,
    kind: Manifolds,
    manifolds: &mut Vec<ContactManifold<M, C>>,
) {
    let mut old = std::mem::take(manifolds);
    let before = old.iter().flat_map(|m| &m.points);
    let before: Vec<_> = before.map(|c| [c.fid1, c.fid2]).collect();
    for contact in pair.contacts(pos12, prediction, kind, &before) {
        let tracked = tracked(&contact, &old);
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

fn fits<M, C>(manifold: &ContactManifold<M, C>, normal: Vec3) -> bool {
    core_vector(manifold.local_n1).dot(normal) > SAME_NORMAL
}

fn tracked<M, C: Default + Copy>(
    contact: &PairContact,
    old: &[ContactManifold<M, C>],
) -> TrackedContact<C> {
    let [point1, point2] = contact.points.map(vector);
    let [id1, id2] = contact.ids;
    let dist = real(-contact.penetration);
    let mut tracked = TrackedContact::new(point1, point2, id1, id2, dist);
    let mut known = old.iter().flat_map(|m| &m.points);
    if let Some(same) = known.find(|o| (o.fid1, o.fid2) == (id1, id2)) {
        tracked.data = same.data;
    }
    tracked
}
