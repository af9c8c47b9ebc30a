//! How much a contact counts by its depth and by its normal.

use wide::f32x4;

/// At which fraction of the margin further outside than the deepest a contact counts half, if the
/// shell hardly moves.
const CLOSE: f32 = 0.01;

/// Contacts that count less than this part of what the deepest does are picked only when no others
/// are left.
pub(super) const LEAST_WEIGHT: f32 = 1.0 / 2.0;

/// So many contacts hold a body on what is flat, whatever way it falls.
pub(super) const STANDS_ON: usize = 4;

/// By which part of its distance from the deepest contact another one may be off the plane through
/// that, and the field is flat: what a turn of its normal by 5 degrees makes on the way there.
pub(super) const BENT: f32 = 0.04;

/// Those that count this part of it or more are kept when such are needed.
pub(super) const KEPT_WEIGHT: f32 = 1.0 / 256.0;

/// What a contact counts whose normal is square to that of the deepest.
pub(super) const ASKEW: f32 = 0.25;

/// How contacts outside of the solid count.
#[derive(Clone, Copy)]
pub(super) struct Closeness {
    pub(super) margin: f32,
    pub(super) motion: Option<f32>,
}

impl Closeness {
    /// What is no distance to speak of, in metres.
    pub(super) fn close(&self) -> f32 {
        (self.margin * CLOSE).max(f32::MIN_POSITIVE)
    }

    /// How much further outside than the deepest one a contact counts half, in metres.
    pub(super) fn half(&self, deepest: f32) -> f32 {
        let next = match self.motion {
            Some(motion) => motion,
            // It came from further away than the margin.
            None => outside(deepest),
        };
        next.min(self.margin).max(self.close())
    }

    /// From which penetration on contacts count at least a part of what the deepest does.
    pub(super) fn least_deep(&self, deepest: f32, part: f32) -> f32 {
        let half = self.half(deepest);
        let further = f32x4::splat(half * half * (1.0 / part - 1.0)).sqrt();
        -(outside(deepest) + further.to_array()[0]).min(self.margin)
    }
}

/// How far outside of the solid something is, in metres.
pub(super) fn outside(penetration: f32) -> f32 {
    (-penetration).max(0.0)
}
