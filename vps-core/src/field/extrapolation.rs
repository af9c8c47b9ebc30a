//! Extrapolation of a map beyond its grid.
//!
//! The grid G is a box. Let c be its closest point to a point p outside; all of G then lies beyond
//! the plane through c perpendicular to p − c. The solid lies in a box B within G. For any point q
//! of the solid, with w = p − c (zero along axes on which p is within the grid) and the gap g from
//! B to G along the other axes,
//!
//! |p − q|² = |c − q|² + |w|² + 2 w·(c − q) ≥ d(c)² + |w|² + 2 w·g,
//!
//! so √(d(c)² + w·(w + 2 g)) is a lower bound on the distance of p. It is exact where the face of B
//! is the surface, and continues d(c) without a jump. A map samples it outside of the grid, with
//! the sampled value at c for d(c). A point outside of the grid is outside of the solid for any
//! value there.

use glamx::Vec3;
use wide::f32x4;

use crate::aabb::Aabb;
use crate::simd::Vectors;

/// Points outside of a grid, relative to the closest points of the grid.
#[derive(Clone, Copy)]
pub(crate) struct Extrapolation {
    /// From the grid to the points, in metres: w.
    pub(super) offset: Vectors,
    /// From the box of the solid to the closest points of the grid, in metres: g along the axes on
    /// which the points are outside.
    pub(super) gap: Vectors,
}

impl Extrapolation {
    /// `clamped` are the closest points of the grid; `offset` leads from them to the points.
    #[inline(always)]
    pub(crate) fn new(clamped: Vectors, offset: Vectors, solid: &Aabb) -> Self {
        Self {
            offset,
            gap: clamped.minus(clamped.clamped(solid)),
        }
    }

    /// The penetrations at the points, given those at the closest points of the grid.
    #[inline(always)]
    pub(crate) fn penetrations(&self, at_clamped: f32x4) -> f32x4 {
        extended(at_clamped, self.exterior_square())
    }

    /// The part w·(w + 2 g) of the squared distance; w is zero along axes within the grid.
    #[inline(always)]
    pub(crate) fn exterior_square(&self) -> f32x4 {
        self.offset.dot(self.offset.plus(self.gap).plus(self.gap))
    }

    /// The gradients of [`penetrations`](Self::penetrations), per metre, given penetrations and
    /// gradients at the closest points of the grid.
    #[inline(always)]
    pub(crate) fn gradients(&self, at_clamped: f32x4, gradients: Vectors) -> Vectors {
        let depth = at_clamped.fast_min(f32x4::ZERO);
        let penetrations = self.penetrations(at_clamped);
        let is_separated = penetrations.simd_lt(f32x4::ZERO);
        let reciprocal = is_separated & (f32x4::ONE / penetrations);
        let slope = |offset: f32x4, gap: f32x4, gradient: f32x4| {
            let is_outside = offset.abs().simd_gt(f32x4::ZERO);
            is_outside.select(offset + gap, depth * gradient) * reciprocal
        };
        Vectors {
            x: slope(self.offset.x, self.gap.x, gradients.x),
            y: slope(self.offset.y, self.gap.y, gradients.y),
            z: slope(self.offset.z, self.gap.z, gradients.z),
        }
    }

    /// Upper bounds on [`penetrations`](Self::penetrations) in balls of `radii` around the points,
    /// given that no penetration in the grid exceeds `at_clamped` plus the distance from the
    /// closest point. Infinite for a ball that reaches the grid where penetrations may be positive.
    ///
    /// For two points, the distance of the closest points in the grid and the difference of the
    /// offsets are the legs of a right triangle whose hypotenuse is at most the distance of the two
    /// points. So the vector of d(c) and of w + g moves by at most the radius, and its length
    /// shrinks by at most that.
    #[inline(always)]
    pub(crate) fn bounds(&self, at_clamped: f32x4, radii: f32x4) -> f32x4 {
        let depth = at_clamped.fast_min(f32x4::ZERO);
        let is_outside = Vectors::ZERO.is_less(self.offset.abs());
        let gap = is_outside.select(self.gap, Vectors::ZERO);
        let from_solid = self.offset.plus(gap);
        let shortest = (depth * depth + from_solid.dot(from_solid)).sqrt() - radii;
        let gap = gap.length();
        // In factors: the difference of squares would cancel.
        let square =
            (shortest - gap).fast_max(f32x4::ZERO) * (shortest + gap).fast_max(f32x4::ZERO);
        let stays_outside = self.offset.length().simd_ge(radii);
        let is_bounded = stays_outside | (at_clamped + radii).simd_le(f32x4::ZERO);
        is_bounded.select(-square.sqrt(), f32x4::splat(f32::INFINITY))
    }
}

/// The penetration beyond the grid, given that at the closest points of the grid and
/// [`Extrapolation::exterior_square`].
#[inline(always)]
pub(crate) fn extended(at_clamped: f32x4, exterior_square: f32x4) -> f32x4 {
    let depth = at_clamped.fast_min(f32x4::ZERO);
    -(depth * depth + exterior_square).sqrt()
}

/// The penetration at a single `point`, given that at `clamped`, its closest point in the grid.
#[inline]
pub(crate) fn extrapolated_penetration(
    point: Vec3,
    clamped: Vec3,
    solid: &Aabb,
    at_clamped: f32,
) -> f32 {
    if point == clamped {
        return at_clamped;
    }
    let [clamped, offset] = [clamped, point - clamped].map(Vectors::splat);
    let extrapolation = Extrapolation::new(clamped, offset, solid);
    extrapolation
        .penetrations(f32x4::splat(at_clamped))
        .to_array()[0]
}

/// The inward direction at a single `point`, the normalised gradient of the extrapolated penetration,
/// given the direction and the penetration at `clamped`.
#[inline]
pub(crate) fn extrapolated_direction(
    point: Vec3,
    clamped: Vec3,
    solid: &Aabb,
    at_clamped: f32,
    direction: Vec3,
) -> Vec3 {
    if point == clamped {
        return direction;
    }
    let is_outside = point.cmpne(clamped);
    // Proportional to the gradient: w + g along the axes outside, d ∇d along the others.
    let along = direction * at_clamped.abs();
    Vec3::select(is_outside, solid.clamp(clamped) - point, along).normalize_or_zero()
}
