//! The error of sampled values relative to the exact penetration.

use wide::f32x4;

use crate::map::ErrorBounds;

/// The error of the values around a sample.
pub(super) struct ErrorModel {
    error_bounds: ErrorBounds,
    /// Samples closer to zero, in metres, depend on values of the narrow band alone.
    narrow_band: f32,
}

impl ErrorModel {
    /// `reach` is the largest difference in metres between a sample and any of the values around it.
    #[inline(always)]
    pub(super) fn new(error_bounds: ErrorBounds, reach: f32) -> Self {
        Self {
            error_bounds,
            narrow_band: error_bounds.narrow_band - reach,
        }
    }

    /// The largest error of the values around samples.
    #[inline(always)]
    pub(super) fn error_at(&self, sampled: f32x4) -> f32x4 {
        let is_far = sampled.abs().simd_gt(f32x4::splat(self.narrow_band));
        is_far.select(
            f32x4::splat(self.error_bounds.beyond),
            f32x4::splat(self.error_bounds.in_band),
        )
    }

    /// Upper bounds on samples, given upper bounds `exact` on samples of values without error.
    /// `weight` is the factor by which the error of a value enters a sample.
    #[inline(always)]
    pub(super) fn upper_bound(&self, exact: f32x4, weight: f32x4) -> f32x4 {
        let near = exact + weight * self.error_bounds.in_band;
        let far = exact + weight * self.error_bounds.beyond;
        // Beyond the narrow band the error is larger, but outside those values stay below the band.
        let outside = near.fast_max(far.fast_min(f32x4::splat(-self.narrow_band)));
        far.simd_gt(f32x4::splat(self.narrow_band))
            .select(far, outside)
    }
}
