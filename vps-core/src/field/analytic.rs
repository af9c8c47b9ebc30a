//! Analytic convex solids, whose penetration is exact.

use glamx::Vec3;
use wide::f32x4;

use crate::aabb::Aabb;
use crate::field::discs::Discs;
use crate::field::distance_field::DistanceField;
use crate::simd::{LANES, Points, Vectors};

/// A convex solid. Its penetration is concave: nowhere above its linear approximation at any point.
pub(crate) trait Convex {
    /// Penetrations in metres, and their gradients, of unit or zero length.
    fn sample(&self, points: Vectors) -> (f32x4, Vectors);

    /// A box that contains the solid.
    fn bounds(&self) -> Aabb;

    /// The magnitude of the lengths a penetration is computed from, in metres, for the rounding error.
    fn magnitude(&self) -> f32;
}

impl<S: Convex> DistanceField for S {
    #[inline]
    fn penetration(&self, point: Vec3, _normal: Vec3) -> f32 {
        self.sample(Vectors::splat(point)).0.to_array()[0]
    }

    #[inline]
    fn inward_direction(&self, point: Vec3) -> Vec3 {
        Points::from(self.sample(Vectors::splat(point)).1).get(0)
    }

    #[inline]
    fn penetration_bound(&self, center: Vec3, radius: f32) -> f32 {
        self.penetration(center, Vec3::ZERO) + radius
    }

    fn bounds(&self) -> Aabb {
        Convex::bounds(self)
    }

    fn error_bound(&self) -> f32 {
        8.0 * f32::EPSILON * self.magnitude()
    }

    #[inline(always)]
    fn penetrations(&self, points: &Points, _normals: &Points) -> [f32; LANES] {
        self.sample((*points).into()).0.to_array()
    }

    #[inline(always)]
    fn penetrations_and_gradients(
        &self,
        points: &Points,
        _normals: &Points,
    ) -> ([f32; LANES], Points) {
        let (penetrations, gradients) = self.sample((*points).into());
        (penetrations.to_array(), gradients.into())
    }

    #[inline(always)]
    fn penetration_bounds(&self, discs: &Discs) -> [f32; LANES] {
        let (penetrations, gradients) = self.sample(discs.centers.into());
        (penetrations + discs.rise(gradients, f32x4::ONE)).to_array()
    }
}

/// A ball centred at the origin.
///
/// ```
/// use vps_core::{Ball, DistanceField, Vec3};
///
/// let solid = Ball::new(0.1);
/// let depth = -solid.signed_distance(Vec3::X * 0.08);
/// assert!((depth - 0.02).abs() < 1e-6);
/// ```
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
        Self {
            radius: checked_length("the radius of a ball", radius),
        }
    }
}

impl Convex for Ball {
    #[inline(always)]
    fn sample(&self, points: Vectors) -> (f32x4, Vectors) {
        let (distance, outward) = length_and_direction(points);
        (f32x4::splat(self.radius) - distance, outward.negated())
    }

    fn bounds(&self) -> Aabb {
        centred_box(Vec3::splat(self.radius))
    }

    fn magnitude(&self) -> f32 {
        self.radius
    }
}

/// An axis-aligned box centred at the origin.
///
/// ```
/// use vps_core::{Cuboid, DistanceField, Vec3};
///
/// let solid = Cuboid::new(Vec3::new(0.3, 0.2, 0.1));
/// let depth = -solid.signed_distance(Vec3::Z * 0.09);
/// assert!((depth - 0.01).abs() < 1e-6);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cuboid {
    half_extents: Vec3,
}

impl Cuboid {
    /// A box that extends `half_extents` metres from the origin along each axis.
    ///
    /// # Panics
    /// If a half extent is not positive and finite.
    pub fn new(half_extents: Vec3) -> Self {
        for extent in half_extents.to_array() {
            checked_length("the half extent of a cuboid", extent);
        }
        Self { half_extents }
    }
}

impl Convex for Cuboid {
    #[inline(always)]
    fn sample(&self, points: Vectors) -> (f32x4, Vectors) {
        let outside_faces = points.abs().minus(Vectors::splat(self.half_extents));
        let nearest = outside_faces
            .x
            .fast_max(outside_faces.y)
            .fast_max(outside_faces.z);
        let (outside, outward) = length_and_direction(outside_faces.at_least_zero());
        let penetrations = -(outside + nearest.fast_min(f32x4::ZERO));
        // Inside of the box the gradient is that of the nearest face, the first of equally near ones.
        let x = outside_faces.x.simd_ge(nearest);
        let y = outside_faces.y.simd_ge(nearest) & !x;
        let z = !(x | y);
        let is_inside = nearest.simd_le(f32x4::ZERO);
        let one = |mask: f32x4| mask & f32x4::ONE;
        let gradients = Vectors {
            x: is_inside.select(one(x), outward.x),
            y: is_inside.select(one(y), outward.y),
            z: is_inside.select(one(z), outward.z),
        };
        (penetrations, gradients.with_signs_of(points).negated())
    }

    fn bounds(&self) -> Aabb {
        centred_box(self.half_extents)
    }

    fn magnitude(&self) -> f32 {
        self.half_extents.max_element()
    }
}

/// The half-space on one side of a plane through the origin.
///
/// ```
/// use vps_core::{DistanceField, HalfSpace, Vec3};
///
/// let solid = HalfSpace::new(Vec3::Y);
/// let depth = -solid.signed_distance(Vec3::new(5.0, -0.03, 5.0));
/// assert!((depth - 0.03).abs() < 1e-6);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfSpace {
    outward_normal: Vec3,
}

impl HalfSpace {
    /// The half-space that `outward_normal` points away from.
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

impl Convex for HalfSpace {
    #[inline(always)]
    fn sample(&self, points: Vectors) -> (f32x4, Vectors) {
        let inward = Vectors::splat(-self.outward_normal);
        (points.dot(inward), inward)
    }

    fn bounds(&self) -> Aabb {
        centred_box(Vec3::INFINITY)
    }

    fn magnitude(&self) -> f32 {
        1.0
    }
}

/// The points within a radius of a segment of the y axis centred at the origin.
///
/// ```
/// use vps_core::{Capsule, DistanceField, Vec3};
///
/// let solid = Capsule::new(0.5, 0.1);
/// let depth = -solid.signed_distance(Vec3::new(0.07, 0.4, 0.0));
/// assert!((depth - 0.03).abs() < 1e-6);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Capsule {
    half_height: f32,
    radius: f32,
}

impl Capsule {
    /// A capsule whose segment extends `half_height` metres from the origin to either side along y.
    ///
    /// # Panics
    /// If a length is not positive and finite.
    pub fn new(half_height: f32, radius: f32) -> Self {
        Self {
            half_height: checked_length("the half height of a capsule", half_height),
            radius: checked_length("the radius of a capsule", radius),
        }
    }
}

impl Convex for Capsule {
    #[inline(always)]
    fn sample(&self, points: Vectors) -> (f32x4, Vectors) {
        let half = f32x4::splat(self.half_height);
        let on_axis = points.y.fast_max(-half).fast_min(half);
        let (distance, outward) = length_and_direction(Vectors {
            y: points.y - on_axis,
            ..points
        });
        (f32x4::splat(self.radius) - distance, outward.negated())
    }

    fn bounds(&self) -> Aabb {
        centred_box(Vec3::new(
            self.radius,
            self.half_height + self.radius,
            self.radius,
        ))
    }

    fn magnitude(&self) -> f32 {
        self.half_height + self.radius
    }
}

/// A cylinder around the y axis, centred at the origin.
///
/// ```
/// use vps_core::{Cylinder, DistanceField, Vec3};
///
/// let solid = Cylinder::new(0.5, 0.1);
/// let depth = -solid.signed_distance(Vec3::new(0.0, 0.48, 0.0));
/// assert!((depth - 0.02).abs() < 1e-6);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder {
    half_height: f32,
    radius: f32,
}

impl Cylinder {
    /// A cylinder that extends `half_height` metres from the origin to either side along y.
    ///
    /// # Panics
    /// If a length is not positive and finite.
    pub fn new(half_height: f32, radius: f32) -> Self {
        Self {
            half_height: checked_length("the half height of a cylinder", half_height),
            radius: checked_length("the radius of a cylinder", radius),
        }
    }
}

impl Convex for Cylinder {
    #[inline(always)]
    fn sample(&self, points: Vectors) -> (f32x4, Vectors) {
        let (zero, one) = (f32x4::ZERO, f32x4::ONE);
        let (from_axis, aside) = length_and_direction(Vectors { y: zero, ..points });
        // Signed distances from the wall and from the ends.
        let wall = from_axis - self.radius;
        let end = points.y.abs() - self.half_height;
        let (outside, outward) = length_and_direction(Vectors {
            x: wall.fast_max(zero),
            y: end.fast_max(zero),
            z: zero,
        });
        let nearest = wall.fast_max(end);
        let is_inside = nearest.simd_le(zero);
        let by_wall = wall.simd_ge(end);
        let aside_part = is_inside.select(by_wall & one, outward.x);
        let up_part = is_inside.select(!by_wall & one, outward.y);
        let up = Vectors {
            x: zero,
            y: up_part,
            z: zero,
        };
        let gradients = aside.times(aside_part).plus(up.with_signs_of(points));
        (-(outside + nearest.fast_min(zero)), gradients.negated())
    }

    fn bounds(&self) -> Aabb {
        centred_box(Vec3::new(self.radius, self.half_height, self.radius))
    }

    fn magnitude(&self) -> f32 {
        self.half_height + self.radius
    }
}

/// Lengths and directions of vectors; the direction of a zero vector is zero.
#[inline(always)]
fn length_and_direction(v: Vectors) -> (f32x4, Vectors) {
    let length = v.length();
    let per_length = length
        .simd_gt(f32x4::ZERO)
        .select(f32x4::ONE / length, f32x4::ZERO);
    (length, v.times(per_length))
}

fn checked_length(what: &str, length: f32) -> f32 {
    assert!(
        length > 0.0 && length.is_finite(),
        "{what} must be positive and finite, not {length}"
    );
    length
}

fn centred_box(corner: Vec3) -> Aabb {
    Aabb {
        min: -corner,
        max: corner,
    }
}
