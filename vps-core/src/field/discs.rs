//! Pieces of a shell for which a field bounds its penetration.

use glamx::Vec3;
use wide::f32x4;

use crate::simd::{LANES, Points, Vectors};

/// Pieces of a shell, each close to a dish: a disc that may be bent like a bowl. A piece holds what
/// is no further than its radius from its centre, and no further than its thickness, measured along
/// its normal, from the height lift + bulge × r² above the plane through the centre, r being the
/// distance from the line through the centre along the normal. Lengths in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Discs {
    /// Their centres.
    pub centers: Points,
    /// Their radii.
    pub radii: [f32; LANES],
    /// Unit normals of their planes.
    pub normals: Points,
    /// How high above its centre the middle of a dish is.
    pub lifts: [f32; LANES],
    /// How much a dish bends towards its normal, per metre.
    pub bulges: [f32; LANES],
    /// How far from its dish a piece reaches on either side.
    pub thickness: [f32; LANES],
}

impl Discs {
    /// As thick as they are wide.
    #[inline(always)]
    pub fn balls(centers: &Points, radii: [f32; LANES]) -> Self {
        Self {
            centers: *centers,
            radii,
            normals: Points::splat(Vec3::Y),
            lifts: [0.0; LANES],
            bulges: [0.0; LANES],
            thickness: radii,
        }
    }

    /// How far a piece reaches from its centre in a direction of length one, in metres, at most: for
    /// fields that look at one piece after the other.
    #[inline]
    pub fn reach(&self, lane: usize, direction: Vec3) -> f32 {
        let radius = self.radii[lane];
        let across = direction.dot(self.normals.get(lane));
        let along = f32x4::splat((1.0 - across * across).max(0.0))
            .sqrt()
            .to_array()[0];
        let bend = across * self.bulges[lane];
        // As in `rise`.
        let r = if bend < 0.0 {
            radius.min(along / (bend * -2.0))
        } else {
            radius
        };
        let on_dish = across * self.lifts[lane]
            + across.abs() * self.thickness[lane]
            + r * (along + bend * r);
        on_dish.min(radius)
    }

    /// The pieces grown to hold what is up to `by` metres away from a point of theirs.
    #[inline(always)]
    pub(crate) fn grown(&self, by: f32) -> Self {
        let radii = f32x4::new(self.radii);
        // A step aside of `by` changes the height of the dish by no more than this.
        let aside = f32x4::new(self.bulges).abs() * (radii + radii + by) * by;
        Self {
            radii: (radii + by).to_array(),
            thickness: (f32x4::new(self.thickness) + by + aside).to_array(),
            ..*self
        }
    }

    /// How much more than at its centre a linear function with the given gradients (per metre),
    /// none longer than `steepest`, is in a piece at most.
    #[inline(always)]
    pub(crate) fn rise(&self, gradients: Vectors, steepest: f32x4) -> f32x4 {
        let normals = Vectors::from(self.normals);
        let radii = f32x4::new(self.radii);
        let across = gradients.dot(normals);
        let along = gradients.minus(normals.times(across)).length();
        // On the dish the function is along r + bend r²: largest at the rim, or before it.
        let bend = across * f32x4::new(self.bulges);
        let before = radii.fast_min(along / (bend * -2.0));
        let r = bend.simd_lt(f32x4::ZERO).select(before, radii);
        let on_dish = across * f32x4::new(self.lifts)
            + across.abs() * f32x4::new(self.thickness)
            + r * (along + bend * r);
        // Never more than in the ball around.
        on_dish.fast_min(steepest * radii)
    }
}
