//! A solid given by a function.

use glamx::Vec3;

use crate::aabb::Aabb;
use crate::field::distance_field::DistanceField;

/// A field given by a function: anything a signed distance, or a bound of one, can be computed of.
///
/// ```
/// use vps_core::{Aabb, DistanceField, FieldFn, Vec3};
/// // A torus around the y axis.
/// let torus = |p: Vec3| 0.1 - Vec3::new(p.x.hypot(p.z) - 0.4, p.y, 0.0).length();
/// let bounds = Aabb { min: Vec3::new(-0.5, -0.1, -0.5), max: Vec3::new(0.5, 0.1, 0.5) };
/// let field = FieldFn::new(torus, 1.0, bounds, 1e-6);
/// assert!((field.penetration(Vec3::new(0.4, 0.0, 0.0), Vec3::Y) - 0.1).abs() < 1e-6);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct FieldFn<F> {
    penetration: F,
    steepness: f32,
    bounds: Aabb,
    error_bound: f32,
}

impl<F: Fn(Vec3) -> f32> FieldFn<F> {
    /// `penetration` in metres, positive inside of the solid, which `bounds` holds.
    ///
    /// No two points may differ in it by more than `steepness` times their distance: 1 for a signed
    /// distance, more for what is only like one. `error_bound` is how far it may be from the exact
    /// penetration near the surface, in metres.
    ///
    /// # Panics
    /// If the steepness is not positive and finite, or the error negative.
    pub fn new(penetration: F, steepness: f32, bounds: Aabb, error_bound: f32) -> Self {
        assert!(
            steepness > 0.0 && steepness.is_finite() && error_bound >= 0.0,
            "a steepness must be positive, an error not negative: {steepness}, {error_bound}"
        );
        Self {
            penetration,
            steepness,
            bounds,
            error_bound,
        }
    }
}

/// How far apart the slope is taken, as a part of the size of the solid.
const STEP: f32 = 1e-3;

impl<F: Fn(Vec3) -> f32> DistanceField for FieldFn<F> {
    fn penetration(&self, point: Vec3, _normal: Vec3) -> f32 {
        (self.penetration)(point)
    }

    /// By differences over a thousandth of the size of the solid.
    fn inward_direction(&self, point: Vec3) -> Vec3 {
        let step = STEP * self.bounds.extents().max_element();
        let slope = |axis: Vec3| {
            (self.penetration)(point + axis * step) - (self.penetration)(point - axis * step)
        };
        Vec3::new(slope(Vec3::X), slope(Vec3::Y), slope(Vec3::Z)).normalize_or_zero()
    }

    fn penetration_bound(&self, center: Vec3, radius: f32) -> f32 {
        (self.penetration)(center) + self.steepness * radius
    }

    fn bounds(&self) -> Aabb {
        self.bounds
    }

    fn error_bound(&self) -> f32 {
        self.error_bound
    }
}
