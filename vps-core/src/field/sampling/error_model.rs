//! From the exact penetration to what is stored and sampled.

use wide::f32x4;

use crate::map::Accuracy;

/// From the exact penetration to what is stored and sampled.
pub(super) struct Stored {
    accuracy: Accuracy,
    /// Sampled values closer to zero are made of near ones alone, in metres.
    near: f32,
}

impl Stored {
    /// `reach` is how far what is sampled may be from any of the values it is made of, in metres.
    #[inline(always)]
    pub(super) fn new(accuracy: Accuracy, reach: f32) -> Self {
        Self {
            accuracy,
            near: accuracy.band_m - reach,
        }
    }

    /// How far the values may be off that give these.
    #[inline(always)]
    pub(super) fn error_at(&self, sampled: f32x4) -> f32x4 {
        let is_far = sampled.abs().simd_gt(f32x4::splat(self.near));
        is_far.select(
            f32x4::splat(self.accuracy.far_m),
            f32x4::splat(self.accuracy.near_m),
        )
    }

    /// The most that can be sampled where values without an error would give `exact` at most;
    /// `times` is how much of the error of a value gets into the result.
    #[inline(always)]
    pub(super) fn of(&self, exact: f32x4, times: f32x4) -> f32x4 {
        let near = exact + times * self.accuracy.near_m;
        let far = exact + times * self.accuracy.far_m;
        // Deep inside values may be far off; so they may far outside, but there they lie below.
        let outside = near.fast_max(far.fast_min(f32x4::splat(-self.near)));
        far.simd_gt(f32x4::splat(self.near)).select(far, outside)
    }
}
