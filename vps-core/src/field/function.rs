//! A solid given by a function.

use glamx::Vec3;

use crate::aabb::Aabb;
use crate::field::distance_field::DistanceField;

/// A field given by a function that computes a signed distance or an approximation of one.
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
    lipschitz: f32,
    bounds: Aabb,
    error_bound: f32,
}

impl<F: Fn(Vec3) -> f32> FieldFn<F> {
    /// `penetration` in metres, positive inside of the solid, which lies in `bounds`.
    ///
    /// `lipschitz` is its Lipschitz constant: 1 for a signed distance, more for an approximation.
    /// `error_bound` is its largest error near the surface, in metres.
    ///
    /// # Panics
    /// If the Lipschitz constant is not positive and finite, or the error negative.
    pub fn new(penetration: F, lipschitz: f32, bounds: Aabb, error_bound: f32) -> Self {
        assert!(
            lipschitz > 0.0 && lipschitz.is_finite() && error_bound >= 0.0,
            "a Lipschitz constant must be positive and finite, an error not negative: {lipschitz}, {error_bound}"
        );
        Self {
            penetration,
            lipschitz,
            bounds,
            error_bound,
        }
    }
}

/// Step of the finite differences, as a fraction of the size of the solid.
const DIFFERENCE_STEP: f32 = 1e-3;

impl<F: Fn(Vec3) -> f32> DistanceField for FieldFn<F> {
    fn penetration(&self, point: Vec3, _normal: Vec3) -> f32 {
        (self.penetration)(point)
    }

    /// By central differences with a step of a thousandth of the size of the solid.
    fn inward_direction(&self, point: Vec3) -> Vec3 {
        let step = DIFFERENCE_STEP * self.bounds.extents().max_element();
        let slope = |axis: Vec3| {
            (self.penetration)(point + axis * step) - (self.penetration)(point - axis * step)
        };
        Vec3::new(slope(Vec3::X), slope(Vec3::Y), slope(Vec3::Z)).normalize_or_zero()
    }

    fn penetration_bound(&self, center: Vec3, radius: f32) -> f32 {
        (self.penetration)(center) + self.lipschitz * radius
    }

    fn bounds(&self) -> Aabb {
        self.bounds
    }

    fn error_bound(&self) -> f32 {
        self.error_bound
    }
}
