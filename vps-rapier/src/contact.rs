//! A contact between the surfaces of two shapes, and the choice of a few.

use rapier3d::parry::query::Contact as ParryContact;
use rapier3d::parry::shape::PackedFeatureId;
use vps_core::{Contact, ContactManifold, Vec3};

use crate::real::{real, vector};

/// A contact between two surfaces; of each pair one thing is the first shape's and one the second's.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PairContact {
    /// A point on each surface, in the frame of its shape in metres.
    pub(crate) points: [Vec3; 2],
    /// The unit normal out of each shape, in its frame: the two are opposite.
    pub(crate) normals: [Vec3; 2],
    /// What stays the same from step to step.
    pub(crate) ids: [PackedFeatureId; 2],
    /// In metres, positive inside.
    pub(crate) penetration: f32,
}

impl PairContact {
    /// The same contact seen with the shapes in the other order.
    pub(crate) fn flipped(self) -> Self {
        let flip = |[a, b]: [Vec3; 2]| [b, a];
        Self {
            points: flip(self.points),
            normals: flip(self.normals),
            ids: [self.ids[1], self.ids[0]],
            penetration: self.penetration,
        }
    }

    pub(crate) fn to_parry(self) -> ParryContact {
        let [point1, point2] = self.points.map(vector);
        let [normal1, normal2] = self.normals.map(vector);
        ParryContact::new(point1, point2, normal1, normal2, real(-self.penetration))
    }
}

/// Keeps at most `N`: the deepest first, then those that spread over the largest area, seen along
/// the normal of the deepest (section 3.2).
pub(crate) fn spread<const N: usize>(contacts: &mut Vec<PairContact>, margin: f32) {
    if contacts.len() <= 1 {
        return;
    }
    let numbered = (0..).zip(&*contacts).map(|(point, c)| Contact {
        point,
        position: c.points[0],
        normal: c.normals[0],
        penetration: c.penetration,
    });
    let numbered: Vec<Contact> = numbered.collect();
    let deeper = |a: &Contact, b: &Contact| {
        let by_depth = a.penetration.total_cmp(&b.penetration);
        by_depth.then(b.point.cmp(&a.point))
    };
    let Some(deepest) = numbered.iter().copied().max_by(deeper) else {
        return;
    };
    let picked = ContactManifold::<N>::spread(&numbered, deepest.normal, margin);
    let picked = picked.contacts().iter();
    *contacts = picked.map(|c| contacts[c.point as usize]).collect();
}

/// Whether contacts of the step before are as good as the ones an engine would get now: as many, as
/// deep but for `tolerance`, and almost as wide apart. Then they stay, so that a body at rest is not
/// handed from one choice among many equal ones to the next.
pub(crate) fn is_as_good(before: &[PairContact], now: &[PairContact], tolerance: f32) -> bool {
    let deepest = |contacts: &[PairContact]| {
        let depths = contacts.iter().map(|c| c.penetration);
        depths.fold(f32::NEG_INFINITY, f32::max)
    };
    let shallowest = |contacts: &[PairContact]| {
        let depths = contacts.iter().map(|c| c.penetration);
        depths.fold(f32::INFINITY, f32::min)
    };
    before.len() == now.len()
        && deepest(before) >= deepest(now) - tolerance
        && shallowest(before) >= shallowest(now) - tolerance
        && spread_of(before) >= ALMOST * spread_of(now)
}

/// How much of the spread of the best contacts is enough.
const ALMOST: f32 = 0.8;

/// The sum of all squared distances between two contacts, in m².
fn spread_of(contacts: &[PairContact]) -> f32 {
    let pairs = (0..contacts.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
    pairs
        .map(|(i, j)| contacts[i].points[0].distance_squared(contacts[j].points[0]))
        .sum()
}
