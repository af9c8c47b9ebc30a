//! Solids whose penetration is exact.

use glamx::Vec3;

use crate::{Aabb, DistanceField};

/// A ball around the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    radius: f32,
}

impl Ball {
    /// A ball of `radius` metres.
    ///
    /// # Panics
    /// If the radius is not positive and finite.
    pub fn new(radius: f32) -> Self {
        assert!(
            radius > 0.0 && radius.is_finite(),
            "the radius of a ball must be positive and finite, not {radius}"
        );
        Self { radius }
    }
}

impl DistanceField for Ball {
    fn penetration(&self, point: Vec3, _normal: Vec3) -> f32 {
        self.radius - point.length()
    }

    fn inward_direction(&self, point: Vec3) -> Vec3 {
        -point.normalize_or_zero()
    }

    fn penetration_bound(&self, center: Vec3, radius: f32) -> f32 {
        self.penetration(center, Vec3::ZERO) + radius
    }

    fn bounds(&self) -> Aabb {
        let corner = Vec3::splat(self.radius);
        Aabb {
            min: -corner,
            max: corner,
        }
    }

    fn error_bound(&self) -> f32 {
        rounding(self.radius)
    }
}

/// A box around the origin, its edges along the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cuboid {
    half_extents: Vec3,
}

impl Cuboid {
    /// A box that reaches `half_extents` metres from the origin along each axis.
    ///
    /// # Panics
    /// If a half extent is not positive and finite.
    pub fn new(half_extents: Vec3) -> Self {
        assert!(
            half_extents.min_element() > 0.0 && half_extents.is_finite(),
            "the half extents of a cuboid must be positive and finite, not {half_extents}"
        );
        Self { half_extents }
    }
}

impl DistanceField for Cuboid {
    fn penetration(&self, point: Vec3, _normal: Vec3) -> f32 {
        let outside = point.abs() - self.half_extents;
        -(outside.max(Vec3::ZERO).length() + outside.max_element().min(0.0))
    }

    fn inward_direction(&self, point: Vec3) -> Vec3 {
        let outside = point.abs() - self.half_extents;
        let away = if outside.max_element() > 0.0 {
            outside.max(Vec3::ZERO)
        } else {
            // The nearest face; the first of equally near ones.
            let nearest = outside.max_element();
            if outside.x == nearest {
                Vec3::X
            } else if outside.y == nearest {
                Vec3::Y
            } else {
                Vec3::Z
            }
        };
        -(away * point.signum()).normalize_or_zero()
    }

    fn penetration_bound(&self, center: Vec3, radius: f32) -> f32 {
        self.penetration(center, Vec3::ZERO) + radius
    }

    fn bounds(&self) -> Aabb {
        Aabb {
            min: -self.half_extents,
            max: self.half_extents,
        }
    }

    fn error_bound(&self) -> f32 {
        rounding(self.half_extents.max_element())
    }
}

/// All of space on one side of a plane through the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfSpace {
    outward_normal: Vec3,
}

impl HalfSpace {
    /// The half-space `outward_normal` points away from.
    ///
    /// # Panics
    /// If the normal is zero or not finite.
    pub fn new(outward_normal: Vec3) -> Self {
        let normal = outward_normal
            .try_normalize()
            .expect("the normal of a half-space must be finite and not zero");
        Self {
            outward_normal: normal,
        }
    }
}

impl DistanceField for HalfSpace {
    fn penetration(&self, point: Vec3, _normal: Vec3) -> f32 {
        -point.dot(self.outward_normal)
    }

    fn inward_direction(&self, _point: Vec3) -> Vec3 {
        -self.outward_normal
    }

    fn penetration_bound(&self, center: Vec3, radius: f32) -> f32 {
        self.penetration(center, Vec3::ZERO) + radius
    }

    fn bounds(&self) -> Aabb {
        Aabb {
            min: Vec3::splat(f32::NEG_INFINITY),
            max: Vec3::splat(f32::INFINITY),
        }
    }

    fn error_bound(&self) -> f32 {
        rounding(1.0)
    }
}

/// Rounding error of a penetration computed from coordinates of the given size.
fn rounding(size: f32) -> f32 {
    8.0 * f32::EPSILON * size
}
