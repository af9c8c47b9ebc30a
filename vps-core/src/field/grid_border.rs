//! Upper bounds for pieces of a shell that leave the grid of a map.

use wide::f32x4;

use crate::aabb::Aabb;
use crate::field::discs::Discs;
use crate::simd::Vectors;

/// No vectors, and no coordinates where vectors are masks.
const NONE: Vectors = Vectors {
    x: f32x4::ZERO,
    y: f32x4::ZERO,
    z: f32x4::ZERO,
};

/// A linear function that what is interpolated in the grid hardly exceeds, around the point of the
/// grid that is closest to the centre of a piece.
#[derive(Clone, Copy)]
pub(crate) struct Tangent {
    /// The penetration at that point.
    pub(crate) value: f32x4,
    /// And its gradient, per metre.
    pub(crate) gradient: Vectors,
    /// By how much it is exceeded at most, as far from that point as the piece reaches from its
    /// centre.
    pub(crate) excess: f32x4,
}

/// The border of a grid where pieces are.
///
/// A piece is bounded by linear functions that hold for all its points that leave the grid along the
/// same axes. In the grid that is the one given. Outside, the vector z of d(c) and of w + g is as
/// long as √(V² + |g|²), and no shorter than e·z for any unit vector e: e is taken along z where the
/// piece comes closest, for an e taken along the z of its centre. Of points that leave along an axis
/// on which others do not, no more is used than that |V| ≥ d(c).
#[derive(Clone, Copy)]
pub(crate) struct Border {
    /// From the closest points of the grid to the centres: zero along axes that do not leave it.
    way: Vectors,
    /// From the closest point of the border to the centre along each axis, inside as well.
    from_border: Vectors,
    /// From the box of the solid to the border there.
    gap: Vectors,
    /// Axes along which all points of a piece leave the grid.
    leave: Vectors,
    /// Axes along which some may.
    straddle: Vectors,
}

impl Border {
    /// `inside` are the points of the `grid` that are closest to the centres of the pieces.
    #[inline(always)]
    pub(crate) fn new(discs: &Discs, inside: Vectors, grid: &Aabb, solid: &Aabb) -> Self {
        let (centers, radii) = (Vectors::from(discs.centers), f32x4::new(discs.radii));
        let from_low = centers.minus(Vectors::splat(grid.min));
        let from_high = centers.minus(Vectors::splat(grid.max));
        let is_low = from_low.abs().is_less(from_high.abs());
        let from_border = is_low.select(from_low, from_high);
        let border = centers.minus(from_border);
        let way = centers.minus(inside);
        let is_out = NONE.is_less(way.abs());
        let (x, y, z) = (radii, radii, radii);
        let straddle = from_border.abs().is_less(Vectors { x, y, z });
        Self {
            way,
            from_border,
            gap: border.minus(border.clamped(solid)),
            leave: straddle.select(NONE, is_out),
            straddle,
        }
    }

    /// Pieces that straddle the border along no more than one axis: only of these
    /// [`bounds`](Self::bounds) says anything.
    #[inline(always)]
    pub(crate) fn is_simple(&self) -> f32x4 {
        let Vectors { x, y, z } = self.straddle;
        !((x & y) | (y & z) | (z & x))
    }

    /// Upper bounds of what is sampled in the pieces.
    #[inline(always)]
    pub(crate) fn bounds(&self, discs: &Discs, tangent: &Tangent) -> f32x4 {
        let bounds = self.bounds_of(discs, tangent, NONE);
        if self.straddle.any().any() {
            bounds.fast_max(self.bounds_of(discs, tangent, self.straddle))
        } else {
            bounds
        }
    }

    /// The same for those points that also leave the grid along the axes `beside`.
    #[inline(always)]
    fn bounds_of(&self, discs: &Discs, tangent: &Tangent, beside: Vectors) -> f32x4 {
        // Where the closest point of the grid is that belongs to the centre then.
        let to_border = self.way.minus(self.from_border);
        let shift = beside.select(to_border, self.leave.select(to_border, self.way));
        let value = tangent.value + tangent.gradient.dot(shift);
        let gradient = beside.select(NONE, self.leave.select(NONE, tangent.gradient));
        let leaves = self.leave.any();
        if !leaves.any() {
            return value + discs.rise(gradient, gradient.length()) + tangent.excess;
        }
        let gap = self.leave.select(self.gap, NONE);
        let out = self.leave.select(self.from_border.plus(self.gap), NONE);
        let along = |distance: f32x4, out: Vectors| {
            let depth = distance.fast_max(f32x4::ZERO);
            let length = (depth * depth + out.dot(out)).sqrt();
            let shorter = length.simd_gt(f32x4::ZERO) & (f32x4::ONE / length);
            (
                leaves.select(depth * shorter, f32x4::ONE),
                out.times(shorter),
            )
        };
        let rise = |(of_distance, of_out): (f32x4, Vectors)| {
            let slope = gradient.times(of_distance).minus(of_out);
            let steepest = slope.length();
            (slope, steepest, discs.rise(slope, steepest))
        };
        let (slope, steepest, rises) = rise(along(-value, out));
        let step = slope.times(steepest.simd_gt(f32x4::ZERO) & (rises / (steepest * steepest)));
        let closest = along(
            -value - gradient.dot(step),
            self.leave.select(out.plus(step), NONE),
        );
        let (of_distance, of_out) = closest;
        let (_, _, rises) = rise(closest);
        let least = of_out.dot(out) - of_distance * (value + tangent.excess) - rises;
        let gap = gap.length();
        // By factors: the difference of squares would be lost to rounding.
        let square = (least - gap).fast_max(f32x4::ZERO) * (least + gap).fast_max(f32x4::ZERO);
        -leaves.select(square.sqrt(), least)
    }
}
