//! The conformance suite of [`DistanceField`], for the tests of implementations.

use glamx::Vec3;

use crate::aabb::Aabb;
use crate::field::discs::Discs;
use crate::field::distance_field::DistanceField;
use crate::simd::{LANES, Points};

/// A violated requirement of [`DistanceField`].
///
/// ```
/// use vps_core::conformance::{Violation, check};
/// use vps_core::{Aabb, FieldFn, Vec3};
///
/// // Grows twice as fast as stated.
/// let ball = |p: Vec3| 2.0 * (0.1 - p.length());
/// let bounds = Aabb { min: Vec3::splat(-0.1), max: Vec3::splat(0.1) };
/// let field = FieldFn::new(ball, 1.0, bounds, 0.0);
/// let found = check(&field, Vec3::X * 0.2, 0.1, Vec3::NEG_X, Vec3::Y);
/// assert!(matches!(found, Err(Violation::Bound { .. })));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Violation {
    /// The bound of a ball or disc is below the penetration of a point in it.
    #[error(
        "the {piece} around {center} of radius {radius} m has bound {bound} m, but {point} in it has {penetration} m"
    )]
    Bound {
        /// Ball or disc.
        piece: &'static str,
        /// Its centre.
        center: Vec3,
        /// Its radius in metres.
        radius: f32,
        /// The bound.
        bound: f32,
        /// The point.
        point: Vec3,
        /// Its penetration.
        penetration: f32,
    },
    /// A disc has a higher bound than the ball around it.
    #[error("the disc around {center} has bound {disc} m, the ball {ball} m")]
    Disc {
        /// Its centre.
        center: Vec3,
        /// Its bound.
        disc: f32,
        /// The bound of the ball.
        ball: f32,
    },
    /// The penetration of a point differs between the scalar and the SIMD method.
    #[error("{point} has penetration {alone} m alone, but {together} m with others")]
    Lanes {
        /// The point.
        point: Vec3,
        /// Its penetration.
        alone: f32,
        /// Its penetration as one of several points.
        together: f32,
    },
    /// A point of the solid lies outside of the bounds.
    #[error("{point} is {penetration} m inside, but out of bounds {bounds:?}")]
    Bounds {
        /// The point.
        point: Vec3,
        /// Its penetration.
        penetration: f32,
        /// The bounds.
        bounds: Aabb,
    },
    /// A gradient is not finite.
    #[error("the gradient at {point} is {gradient}")]
    Gradient {
        /// The point.
        point: Vec3,
        /// The gradient.
        gradient: Vec3,
    },
    /// The inward direction is not of length one (or zero).
    #[error("the inward direction at {point} has length {length}")]
    Direction {
        /// The point.
        point: Vec3,
        /// Length of the direction.
        length: f32,
    },
}

/// Checks the requirements for a ball, discs, and a point in all of them. `inside` lies in the unit
/// ball and is scaled to the ball around `center`. The unit vector `normal` is the normal of the
/// discs and of the point. The discs are flat or curved to either side, and thick enough to contain
/// the point.
///
/// # Errors
/// The first violation.
///
/// ```
/// use vps_core::{Ball, Vec3, conformance};
///
/// conformance::check(&Ball::new(0.1), Vec3::Y * 0.1, 0.03, Vec3::X * 0.7, Vec3::Y)?;
/// # Ok::<(), conformance::Violation>(())
/// ```
pub fn check(
    field: &impl DistanceField,
    center: Vec3,
    radius: f32,
    inside: Vec3,
    normal: Vec3,
) -> Result<(), Violation> {
    let point = center + inside * radius;
    let penetration = field.penetration(point, normal);
    let rounding = 16.0 * f32::EPSILON * (center.length() + radius);
    let radius = radius + rounding;
    let ball = field.penetration_bound(center, radius);
    let height = (point - center).dot(normal);
    let square = (point - center - normal * height).length_squared();
    let mut discs = Discs {
        centers: Points::splat(center),
        radii: [radius; LANES],
        normals: Points::splat(normal),
        apices: [0.0; LANES],
        half_curvatures: [0.0, 0.5 / radius, -0.5 / radius, 1.0 / radius],
        half_thicknesses: [0.0; LANES],
    };
    for lane in 0..LANES {
        let above = height - discs.half_curvatures[lane] * square;
        // The flat disc stays at the centre. The next two have their apex halfway to the point, and
        // the other half as their half thickness; the last one has its apex at the point's height.
        discs.apices[lane] = [0.0, 0.5, 0.5, 1.0][lane] * above;
        discs.half_thicknesses[lane] = (above - discs.apices[lane]).abs() + rounding;
    }
    let bounds = field.penetration_bounds(&discs);
    let pieces = [
        ("ball", ball),
        ("disc", bounds[0]),
        ("paraboloid", bounds[1]),
        ("inverted paraboloid", bounds[2]),
        ("steep paraboloid", bounds[3]),
    ];
    for (piece, bound) in pieces {
        if penetration > bound {
            return Err(Violation::Bound {
                piece,
                center,
                radius,
                bound,
                point,
                penetration,
            });
        }
    }
    for disc in bounds {
        if disc > ball + rounding {
            return Err(Violation::Disc { center, disc, ball });
        }
    }
    let mut points = Points::splat(center);
    points.set(1, point);
    let together = field.penetrations(&points, &Points::splat(normal))[1];
    if together.to_bits() != penetration.to_bits() {
        return Err(Violation::Lanes {
            point,
            alone: penetration,
            together,
        });
    }
    let (together, gradients) = field.penetrations_and_gradients(&points, &Points::splat(normal));
    if together[1].to_bits() != penetration.to_bits() {
        return Err(Violation::Lanes {
            point,
            alone: penetration,
            together: together[1],
        });
    }
    let gradient = gradients.get(1);
    if !gradient.is_finite() {
        return Err(Violation::Gradient { point, gradient });
    }
    let bounds = field.bounds();
    if penetration > field.error_bound() && bounds.distance_outside(point) > rounding {
        return Err(Violation::Bounds {
            point,
            penetration,
            bounds,
        });
    }
    let length = field.inward_direction(point).length();
    if length != 0.0 && (length - 1.0).abs() > 1e-4 {
        return Err(Violation::Direction { point, length });
    }
    Ok(())
}
