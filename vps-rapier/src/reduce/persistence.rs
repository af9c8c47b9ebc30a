//! Persistence of contacts from step to step, and of the impulses an engine starts with.

use rapier3d::parry::query::{ContactManifold, TrackedContact};
use rapier3d::parry::shape::PackedFeatureId;
use vps_core::{Pose3, Vec3};

use super::parameters::{
    PERSISTENCE_DEPTH_FRACTION, PERSISTENCE_SPREAD_FRACTION, WARM_START_COSINE,
};
use crate::precision::core_vector;
use crate::query::pair::Pair;
use crate::query::pair_contact::{PairContact, max_penetration};

/// The contacts of the step before in the present pose, if all can be evaluated. Those that were
/// `found` again are taken from there.
pub(super) fn re_evaluate(
    pair: &Pair<'_>,
    pos12: &Pose3,
    previous: &[[PackedFeatureId; 2]],
    found: &[PairContact],
) -> Option<Vec<PairContact>> {
    let one = |&ids: &[PackedFeatureId; 2]| {
        let again = found.iter().find(|c| c.ids == ids).copied();
        again.or_else(|| {
            let mut shells = pair.shells(pos12);
            shells.find_map(|shell| shell.re_evaluate(pos12, ids))
        })
    };
    previous.iter().map(one).collect()
}

/// Whether the contacts of the step before are as good as new ones: as many, almost as deep, and almost
/// as far apart. Then they persist, so that a body at rest does not change between equal choices from
/// step to step. `tolerance` is a depth in metres.
pub(super) fn should_persist(
    previous: &[PairContact],
    new: &[PairContact],
    tolerance: f32,
) -> bool {
    let min_penetration = |contacts: &[PairContact]| {
        let depths = contacts.iter().map(|c| c.penetration);
        depths.fold(f32::INFINITY, f32::min)
    };
    let tolerance = tolerance + PERSISTENCE_DEPTH_FRACTION * max_penetration(new).max(0.0);
    previous.len() == new.len()
        && max_penetration(previous) >= max_penetration(new) - tolerance
        && min_penetration(previous) >= min_penetration(new) - tolerance
        && spread(previous) >= PERSISTENCE_SPREAD_FRACTION * spread(new)
}

/// Sum of the squared distances between all pairs of contacts, in m².
fn spread(contacts: &[PairContact]) -> f32 {
    let pairs = (0..contacts.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
    pairs
        .map(|(i, j)| contacts[i].points[0].distance_squared(contacts[j].points[0]))
        .sum()
}

/// The identity of a contact in the next step.
pub(crate) struct ContactKey {
    ids: [PackedFeatureId; 2],
    /// On the first shape, in its frame, in metres.
    point: Vec3,
    /// Unit normal out of the first shape.
    normal: Vec3,
}

impl ContactKey {
    pub(crate) fn of_contact(contact: &PairContact) -> Self {
        Self {
            ids: contact.ids,
            point: contact.points[0],
            normal: contact.normals[0],
        }
    }

    pub(crate) fn of_tracked<M, C>(
        manifold: &ContactManifold<M, C>,
        contact: &TrackedContact<C>,
    ) -> Self {
        Self {
            ids: [contact.fid1, contact.fid2],
            point: core_vector(contact.local_p1),
            normal: core_vector(manifold.local_n1),
        }
    }
}

/// Warm starting: the data an engine keeps with each contact, taken from the old contact of the same
/// ids, or else from the closest one left over with a similar normal. So the impulses that support a
/// body are handed on when other points take over.
pub(crate) fn match_previous<M, C: Copy>(
    contacts: &[ContactKey],
    old: &[ContactManifold<M, C>],
) -> Vec<Option<C>> {
    let points = old.iter().flat_map(|m| {
        m.points
            .iter()
            .map(move |p| (ContactKey::of_tracked(m, p), p.data))
    });
    let mut left: Vec<_> = points.collect();
    let mut data: Vec<Option<C>> = contacts
        .iter()
        .map(|contact| {
            let at = left.iter().position(|(key, _)| key.ids == contact.ids)?;
            Some(left.swap_remove(at).1)
        })
        .collect();
    for (contact, data) in contacts.iter().zip(&mut data) {
        if data.is_some() {
            continue;
        }
        let similar = left
            .iter()
            .enumerate()
            .filter(|(_, (key, _))| key.normal.dot(contact.normal) > WARM_START_COSINE);
        let distance = |key: &ContactKey| key.point.distance(contact.point);
        let closest =
            similar.min_by(|(_, (a, _)), (_, (b, _))| distance(a).total_cmp(&distance(b)));
        if let Some((at, _)) = closest {
            *data = Some(left.swap_remove(at).1);
        }
    }
    data
}
