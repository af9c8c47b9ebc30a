//! The interface of a solid to queries.

use glamx::Vec3;

use crate::aabb::Aabb;
use crate::field::discs::Discs;
use crate::simd::{LANES, Points};

/// A solid given by the penetration of points: the negative of a signed distance.
///
/// Everything is in the field's own frame and in metres. Voxelmaps (through their views, such as
/// [`Voxelmap::trilinear`](crate::Voxelmap::trilinear)), analytic shapes and
/// [functions](crate::FieldFn) implement it; [`conformance`](crate::conformance) holds the checks
/// an implementation must pass.
///
/// Queries evaluate several points at a time, by default one after the other. [`raw`](crate::raw) describes
/// how a field evaluates them together, which is faster.
///
/// ```
/// use vps_core::{Aabb, DistanceField, Vec3, conformance};
///
/// /// The layer of 0.2 m around the plane y = 0.
/// struct Layer;
///
/// impl DistanceField for Layer {
///     fn penetration(&self, point: Vec3, _normal: Vec3) -> f32 {
///         0.1 - point.y.abs()
///     }
///     fn inward_direction(&self, point: Vec3) -> Vec3 {
///         if point.y > 0.0 { Vec3::NEG_Y } else { Vec3::Y }
///     }
///     fn penetration_bound(&self, center: Vec3, radius: f32) -> f32 {
///         self.penetration(center, Vec3::ZERO) + radius
///     }
///     fn bounds(&self) -> Aabb {
///         let far = f32::INFINITY;
///         Aabb { min: Vec3::new(-far, -0.1, -far), max: Vec3::new(far, 0.1, far) }
///     }
///     fn error_bound(&self) -> f32 {
///         1e-7
///     }
/// }
///
/// conformance::check(&Layer, Vec3::new(0.0, 0.08, 0.0), 0.05, Vec3::X, Vec3::Y)?;
/// # Ok::<(), conformance::Violation>(())
/// ```
pub trait DistanceField {
    /// Penetration V(P) of a shell point in metres: positive inside, negative outside
    /// (section 2.2).
    ///
    /// `normal` is the unit inward normal of the shell point in the field's frame. Only eq. 4
    /// needs it, for the local part of the penetration; other fields ignore it.
    fn penetration(&self, point: Vec3, normal: Vec3) -> f32;

    /// The unit direction in which penetration grows at `point`, or zero where there is none (at the
    /// centre of a ball).
    fn inward_direction(&self, point: Vec3) -> Vec3;

    /// An upper bound in metres on [`penetration`](Self::penetration) for every point of the ball
    /// around `center`, with any normal. The tighter it is, the more a query can prune.
    fn penetration_bound(&self, center: Vec3, radius: f32) -> f32;

    /// A box that contains the solid.
    fn bounds(&self) -> Aabb;

    /// The largest difference in metres between [`penetration`](Self::penetration) and the exact
    /// one, for points near the surface of the solid. Elsewhere it may be larger: for voxelmaps see
    /// [`Trilinear::overestimate_bound_at`](crate::Trilinear::overestimate_bound_at).
    fn error_bound(&self) -> f32;

    /// The negative of the penetration: positive outside. For fields that need no normal.
    fn signed_distance(&self, point: Vec3) -> f32 {
        -self.penetration(point, Vec3::ZERO)
    }

    /// [`penetration`](Self::penetration) of several points, the same to the bit.
    #[doc(hidden)]
    #[inline(always)]
    fn penetrations(&self, points: &Points, normals: &Points) -> [f32; LANES] {
        core::array::from_fn(|i| self.penetration(points.get(i), normals.get(i)))
    }

    /// [`penetrations`](Self::penetrations), the same to the bit, and their gradients ∇V per metre,
    /// which point inwards. The gradient at a point outside of the solid may be zero. The default
    /// is [`inward_direction`](Self::inward_direction).
    #[doc(hidden)]
    #[inline(always)]
    fn penetrations_and_gradients(
        &self,
        points: &Points,
        normals: &Points,
    ) -> ([f32; LANES], Points) {
        let penetrations = self.penetrations(points, normals);
        let mut gradients = Points::default();
        for (lane, penetration) in penetrations.into_iter().enumerate() {
            if penetration >= 0.0 {
                gradients.set(lane, self.inward_direction(points.get(lane)));
            }
        }
        (penetrations, gradients)
    }

    /// Upper bounds on the [`penetration`](Self::penetration) in several pieces, each at most the
    /// [`penetration_bound`](Self::penetration_bound) of the ball around it. A field with known
    /// curvature can exploit the shape of a piece; the default takes the balls.
    #[doc(hidden)]
    #[inline(always)]
    fn penetration_bounds(&self, discs: &Discs) -> [f32; LANES] {
        core::array::from_fn(|i| self.penetration_bound(discs.centers.get(i), discs.radii[i]))
    }
}
