//! What a map says of points outside of its grid.
//!
//! The grid G is a box, so from the point c of it that is closest to a point p all of G lies beyond
//! the plane through c across p − c. The solid lies in a box B within G. For any point q of the
//! solid, with w = p − c (zero along axes that do not leave the grid) and the gap g from B to G along
//! those axes,
//!
//! |p − q|² = |c − q|² + |w|² + 2 w·(c − q) ≥ d(c)² + |w|² + 2 w·g,
//!
//! so √(d(c)² + w·(w + 2 g)) is never more than the distance of p. It is the distance where the face
//! of B is the surface, and goes on from d(c) without a jump. What is sampled outside is this, made
//! of what is sampled at c; a point outside of the grid is outside of the solid whatever that is.

use glamx::Vec3;
use wide::f32x4;

use crate::aabb::Aabb;
use crate::simd::Vectors;

/// Points outside of a grid as seen from the closest points in it.
#[derive(Clone, Copy)]
pub(crate) struct Beyond {
    /// From the grid to the points, in metres: w.
    way: Vectors,
    /// From the box of the solid to the grid along the axes that leave it: g.
    gap: Vectors,
}

impl Beyond {
    /// `inside` are the points of the grid that are closest to others, `way` is from there to these.
    #[inline(always)]
    pub(crate) fn new(inside: Vectors, way: Vectors, solid: &Aabb) -> Self {
        let gap = inside.minus(inside.clamped(solid));
        let leaving = |way: f32x4, gap: f32x4| way.abs().simd_gt(f32x4::ZERO) & gap;
        Self {
            way,
            gap: Vectors {
                x: leaving(way.x, gap.x),
                y: leaving(way.y, gap.y),
                z: leaving(way.z, gap.z),
            },
        }
    }

    /// Which points are outside.
    #[inline(always)]
    pub(crate) fn is_outside(&self) -> f32x4 {
        self.way.dot(self.way).simd_gt(f32x4::ZERO)
    }

    /// The penetrations there, given those at the closest points of the grid.
    #[inline(always)]
    pub(crate) fn penetrations(&self, at_border: f32x4) -> f32x4 {
        let depth = at_border.fast_min(f32x4::ZERO);
        let further = self.way.dot(self.way.plus(self.gap).plus(self.gap));
        -(depth * depth + further).sqrt()
    }

    /// The gradients of [`penetrations`](Self::penetrations), per metre, given those at the closest
    /// points of the grid.
    #[inline(always)]
    pub(crate) fn gradients(&self, at_border: f32x4, inside: Vectors) -> Vectors {
        let depth = at_border.fast_min(f32x4::ZERO);
        let penetrations = self.penetrations(at_border);
        let is_away = penetrations.simd_lt(f32x4::ZERO);
        let shorter = is_away & (f32x4::ONE / penetrations);
        let slope = |way: f32x4, gap: f32x4, inside: f32x4| {
            let leaves = way.abs().simd_gt(f32x4::ZERO);
            leaves.select(way + gap, depth * inside) * shorter
        };
        Vectors {
            x: slope(self.way.x, self.gap.x, inside.x),
            y: slope(self.way.y, self.gap.y, inside.y),
            z: slope(self.way.z, self.gap.z, inside.z),
        }
    }

    /// Upper bounds of [`penetrations`](Self::penetrations) closer to the points than `radii`, where
    /// penetrations in the grid are no higher than `at_border` plus the way from the closest point;
    /// infinite where they may be positive in the grid, and the ball reaches it.
    ///
    /// Two points and the closest ones in the grid: what these are apart and what the ways differ by
    /// are the sides of a right triangle whose hypotenuse is no longer than the first two are apart.
    /// So the vector of the distance at the border and of w + g ends no further than a radius from
    /// where it ends for the centre, and is at least a radius shorter than that at the worst.
    #[inline(always)]
    pub(crate) fn bounds(&self, at_border: f32x4, radii: f32x4) -> f32x4 {
        let depth = at_border.fast_min(f32x4::ZERO);
        let from_solid = self.way.plus(self.gap);
        let longest = (depth * depth + from_solid.dot(from_solid)).sqrt() - radii;
        let gap = self.gap.length();
        // By factors: the difference of squares would be lost to rounding.
        let square = (longest - gap).fast_max(f32x4::ZERO) * (longest + gap).fast_max(f32x4::ZERO);
        let stays_outside = self.way.length().simd_ge(radii);
        let is_known = stays_outside | (at_border + radii).simd_le(f32x4::ZERO);
        is_known.select(-square.sqrt(), f32x4::splat(f32::INFINITY))
    }
}

/// [`Beyond`] for one point: the penetration at `point`, given that at `inside`, the point of the grid
/// that is closest to it.
#[inline]
pub(crate) fn penetration_beyond(point: Vec3, inside: Vec3, solid: &Aabb, at_border: f32) -> f32 {
    if point == inside {
        return at_border;
    }
    let [inside, way] = [inside, point - inside].map(Vectors::splat);
    let beyond = Beyond::new(inside, way, solid);
    beyond.penetrations(f32x4::splat(at_border)).to_array()[0]
}

/// The inward direction at `point`, the gradient of what is sampled there, given the one and the
/// penetration at `inside`.
#[inline]
pub(crate) fn direction_beyond(
    point: Vec3,
    inside: Vec3,
    solid: &Aabb,
    at_border: f32,
    direction: Vec3,
) -> Vec3 {
    if point == inside {
        return direction;
    }
    let leaves = point.cmpne(inside);
    // In size, as what is sampled changes: along axes that leave by w + g, along others by d ∇d.
    let along = direction * at_border.abs();
    Vec3::select(leaves, solid.clamp(inside) - point, along).normalize_or_zero()
}
