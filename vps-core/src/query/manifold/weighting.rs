//! Weights of contacts by their depth, and the constants of contact reduction.

use wide::f32x4;

use crate::query::approach::Approach;

/// Distance outside of the deepest contact at which a contact has half weight while the shell
/// rests, as a fraction of the prediction distance.
const RESTING_SCALE: f32 = 0.01;

/// Weight, relative to the deepest contact, below which contacts only fill up the manifold.
pub(super) const MIN_WEIGHT: f32 = 1.0 / 2.0;

/// Contacts needed to support a body on a plane, whichever way it tips.
pub(super) const SUPPORT_CONTACTS: usize = 4;

/// Distance of a contact from the plane through the deepest one up to which the field counts as
/// planar, relative to the distance between the two. A normal that turns by 5 degrees over that
/// distance deviates by this much.
pub(super) const PLANARITY_TOLERANCE: f32 = 0.04;

/// Weight, relative to the deepest contact, down to which contacts are buffered to fill up the
/// manifold.
pub(super) const MIN_FILL_WEIGHT: f32 = 1.0 / 256.0;

/// Weight of a contact whose normal is perpendicular to that of the deepest one.
pub(super) const MIN_NORMAL_WEIGHT: f32 = 0.25;

/// The weights of contacts outside of the solid.
#[derive(Clone, Copy)]
pub(super) struct DepthWeighting {
    pub(super) prediction: f32,
    pub(super) approach: Approach,
}

impl DepthWeighting {
    /// Distance in metres within which a contact counts as resting.
    pub(super) fn resting_distance(&self) -> f32 {
        (self.prediction * RESTING_SCALE).max(f32::MIN_POSITIVE)
    }

    /// Distance in metres, measured from the deepest contact outwards, at which the weight is one
    /// half.
    pub(super) fn half_weight_distance(&self, deepest: f32) -> f32 {
        let next = match self.approach {
            Approach::Moved(distance) => distance,
            Approach::Unknown => distance_outside(deepest),
        };
        next.min(self.prediction).max(self.resting_distance())
    }

    /// The penetration in metres from which on contacts have at least the weight `part`, relative
    /// to the deepest one.
    pub(super) fn min_penetration(&self, deepest: f32, part: f32) -> f32 {
        let half_weight_distance = self.half_weight_distance(deepest);
        let further =
            f32x4::splat(half_weight_distance * half_weight_distance * (1.0 / part - 1.0)).sqrt();
        -(distance_outside(deepest) + further.to_array()[0]).min(self.prediction)
    }
}

/// Distance outside of the solid in metres, 0 inside.
pub(super) fn distance_outside(penetration: f32) -> f32 {
    (-penetration).max(0.0)
}
