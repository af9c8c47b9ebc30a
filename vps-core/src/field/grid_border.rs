//! Upper bounds for pieces of a shell that leave the grid of a map.

use wide::f32x4;

use crate::aabb::Aabb;
use crate::field::discs::Discs;
use crate::simd::Vectors;

/// Zero vectors; as masks, no coordinate.
const NONE: Vectors = Vectors {
    x: f32x4::ZERO,
    y: f32x4::ZERO,
    z: f32x4::ZERO,
};

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
/// A piece is bounded by linear functions, one for all its points that leave the grid along the
/// same axes. In the grid it is the given [`LinearBound`]. Outside, the vector z of d(c) and of w +
/// g has the length √(V² + |g|²), which is at least e·z for any unit vector e. First e is taken
/// along the z of the centre; then it is taken along the z of the point of the piece that comes
/// closest for the first e. For points that leave along an axis on which others do not, only |V| ≥
/// d(c) is used.
#[derive(Clone, Copy)]
pub(crate) struct GridBorder {
    /// From the closest points of the grid to the centres: zero along axes within the grid.
    offset: Vectors,
    /// From the closest face of the grid to the centre along each axis, inside of the grid as well.
    from_border: Vectors,
    /// From the box of the solid to that face.
    gap: Vectors,
    /// Axes along which all points of a piece are outside of the grid.
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
        let border = centers.minus(from_border);
        let offset = centers.minus(clamped);
        let is_out = NONE.is_less(offset.abs());
        let (x, y, z) = (radii, radii, radii);
        let straddling = from_border.abs().is_less(Vectors { x, y, z });
        Self {
            offset,
            from_border,
            gap: border.minus(border.clamped(solid)),
            outside: straddling.select(NONE, is_out),
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
        let bounds = self.bounds_of_part(discs, linear, NONE);
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
        let to_border = self.offset.minus(self.from_border);
        let shift = also_outside.select(to_border, self.outside.select(to_border, self.offset));
        let value = linear.value + linear.gradient.dot(shift);
        let gradient = also_outside.select(NONE, self.outside.select(NONE, linear.gradient));
        let is_outside = self.outside.any();
        if !is_outside.any() {
            return value + discs.rise(gradient, gradient.length()) + linear.excess;
        }
        let gap = self.outside.select(self.gap, NONE);
        let out = self.outside.select(self.from_border.plus(self.gap), NONE);
        let along = |distance: f32x4, out: Vectors| {
            let depth = distance.fast_max(f32x4::ZERO);
            let length = (depth * depth + out.dot(out)).sqrt();
            let reciprocal = length.simd_gt(f32x4::ZERO) & (f32x4::ONE / length);
            (
                is_outside.select(depth * reciprocal, f32x4::ONE),
                out.times(reciprocal),
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
            self.outside.select(out.plus(step), NONE),
        );
        let (of_distance, of_out) = closest;
        let (_, _, rises) = rise(closest);
        let shortest = of_out.dot(out) - of_distance * (value + linear.excess) - rises;
        let gap = gap.length();
        // In factors: the difference of squares would cancel.
        let square =
            (shortest - gap).fast_max(f32x4::ZERO) * (shortest + gap).fast_max(f32x4::ZERO);
        -is_outside.select(square.sqrt(), shortest)
    }
}
