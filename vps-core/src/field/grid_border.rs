//! Upper bounds for pieces of a shell that leave the grid of a map.

use wide::f32x4;

use crate::aabb::Aabb;
use crate::field::discs::Discs;
use crate::field::extrapolation::{Extrapolation, extended};
use crate::simd::Vectors;

/// A linear upper bound on the interpolated penetration, up to an excess, around the point of the grid
/// that is closest to the centre of a piece.
#[derive(Clone, Copy)]
pub(crate) struct LinearBound {
    /// The penetration at that point.
    pub(crate) value: f32x4,
    /// The gradient there, per metre.
    pub(crate) gradient: Vectors,
    /// The most by which the function is exceeded within the radius of the piece, in metres.
    pub(crate) excess: f32x4,
}

/// Pieces near the border of a grid.
///
/// In the grid a piece is bounded by a [`LinearBound`]. Outside, that bound holds for the closest
/// points of the grid. Along an axis on which the whole ball around the piece is outside, each point
/// is at least as far out as the centre less the radius.
#[derive(Clone, Copy)]
pub(crate) struct GridBorder {
    /// From the closest points of the grid to the centres: zero along axes within the grid.
    offset: Vectors,
    /// From the closest point of the grid to the point on its border that belongs to the centre.
    to_border: Vectors,
    /// A lower bound on w·(w + 2 g) in the balls.
    exterior_square: f32x4,
    /// Axes along which all points of a ball are outside of the grid.
    outside: Vectors,
    /// Axes along which some points may be outside.
    straddling: Vectors,
}

impl GridBorder {
    /// `clamped` are the closest points of the `grid` to the centres of the pieces.
    #[inline(always)]
    pub(crate) fn new(discs: &Discs, clamped: Vectors, grid: &Aabb, solid: &Aabb) -> Self {
        let (centers, radii) = (Vectors::from(discs.centers), f32x4::new(discs.radii));
        let from_low = centers.minus(Vectors::splat(grid.min));
        let from_high = centers.minus(Vectors::splat(grid.max));
        let is_low = from_low.abs().is_less(from_high.abs());
        let from_border = is_low.select(from_low, from_high);
        let offset = centers.minus(clamped);
        let (x, y, z) = (radii, radii, radii);
        let radii = Vectors { x, y, z };
        let straddling = from_border.abs().is_less(radii);
        let outside = straddling.select(Vectors::ZERO, Vectors::ZERO.is_less(offset.abs()));
        // The points of the balls that are closest to the grid, without signs.
        let closest = Extrapolation {
            offset: outside.select(offset.abs().minus(radii), Vectors::ZERO),
            gap: clamped.minus(clamped.clamped(solid)).abs(),
        };
        Self {
            offset,
            to_border: offset.minus(from_border),
            exterior_square: closest.exterior_square(),
            outside,
            straddling,
        }
    }

    /// The lanes whose piece straddles the border along at most one axis: [`bounds`](Self::bounds)
    /// holds only for these.
    #[inline(always)]
    pub(crate) fn straddles_at_most_one_axis(&self) -> f32x4 {
        let Vectors { x, y, z } = self.straddling;
        !((x & y) | (y & z) | (z & x))
    }

    /// Upper bounds on the sampled penetration in the pieces.
    #[inline(always)]
    pub(crate) fn bounds(&self, discs: &Discs, linear: &LinearBound) -> f32x4 {
        let bounds = self.bounds_of_part(discs, linear, Vectors::ZERO);
        if self.straddling.any().any() {
            bounds.fast_max(self.bounds_of_part(discs, linear, self.straddling))
        } else {
            bounds
        }
    }

    /// The same for the points that are also outside along the axes `also_outside`.
    #[inline(always)]
    fn bounds_of_part(&self, discs: &Discs, linear: &LinearBound, also_outside: Vectors) -> f32x4 {
        // From the closest point of the grid to the one that belongs to the centre in this case.
        let within = self.outside.select(Vectors::ZERO, self.offset);
        let shift = also_outside.select(self.to_border, within);
        let slope = also_outside.select(
            Vectors::ZERO,
            self.outside.select(Vectors::ZERO, linear.gradient),
        );
        let at_grid = linear.value
            + linear.gradient.dot(shift)
            + discs.rise(slope, slope.length())
            + linear.excess;
        let is_outside = self.outside.any();
        if !is_outside.any() {
            return at_grid;
        }
        is_outside.select(extended(at_grid, self.exterior_square), at_grid)
    }
}
