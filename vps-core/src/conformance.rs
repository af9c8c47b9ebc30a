//! What any [`DistanceField`] must satisfy, for the tests of those who implement one.

use glamx::Vec3;

use crate::DistanceField;

/// A promise of [`DistanceField`] that was broken.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Violation {
    /// The bound of a ball is below the penetration of a point in it.
    #[error(
        "the ball around {center} of radius {radius} m has bound {bound} m, but {point} in it has {penetration} m"
    )]
    Bound {
        /// Centre of the ball.
        center: Vec3,
        /// Radius of the ball in metres.
        radius: f32,
        /// What `penetration_bound` gave.
        bound: f32,
        /// The point.
        point: Vec3,
        /// Its penetration.
        penetration: f32,
    },
    /// A point in the solid lies outside of its bounds.
    #[error("{point} is {penetration} m inside, but out of bounds")]
    Bounds {
        /// The point.
        point: Vec3,
        /// Its penetration.
        penetration: f32,
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

/// Checks the promises for a ball and a point in it: `inside` lies in the unit ball and is scaled
/// to the ball around `center`; `normal` is any unit vector.
///
/// # Errors
/// The first promise that is broken.
pub fn check_ball(
    field: &impl DistanceField,
    center: Vec3,
    radius: f32,
    inside: Vec3,
    normal: Vec3,
) -> Result<(), Violation> {
    let point = center + inside * radius;
    let penetration = field.penetration(point, normal);
    let rounding = 16.0 * f32::EPSILON * (center.length() + radius);
    let bound = field.penetration_bound(center, radius + rounding);
    if penetration > bound {
        return Err(Violation::Bound {
            center,
            radius,
            bound,
            point,
            penetration,
        });
    }
    let outside = field.bounds().distance_outside(point);
    if penetration > field.error_bound() && outside > rounding {
        return Err(Violation::Bounds { point, penetration });
    }
    let length = field.inward_direction(point).length();
    if length != 0.0 && (length - 1.0).abs() > 1e-4 {
        return Err(Violation::Direction { point, length });
    }
    Ok(())
}
