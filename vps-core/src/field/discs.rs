//! Pieces of a shell, in which a field bounds the penetration.

use glamx::Vec3;
use wide::f32x4;

use crate::simd::{LANES, Points, Vectors};

/// Pieces of a shell, each within a ball and close to a paraboloid over a disc. A piece contains the
/// points within its radius of its centre whose height above the plane through the centre, along its
/// normal, is apex + half curvature × r² up to its half thickness, r being the distance from the
/// axis through the centre along the normal. Lengths in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Discs {
    /// Their centres.
    pub centers: Points,
    /// Their radii.
    pub radii: [f32; LANES],
    /// Unit normals of their planes.
    pub normals: Points,
    /// Heights of the apices of the paraboloids above the centres.
    pub apices: [f32; LANES],
    /// Half curvatures of the paraboloids, per metre; positive towards the normals.
    pub half_curvatures: [f32; LANES],
    /// The largest distances from the paraboloids to either side, along the normals.
    pub half_thicknesses: [f32; LANES],
}

impl Discs {
    /// Balls: discs as thick as they are wide.
    #[inline(always)]
    pub fn balls(centers: &Points, radii: [f32; LANES]) -> Self {
        Self {
            centers: *centers,
            radii,
            normals: Points::splat(Vec3::Y),
            apices: [0.0; LANES],
            half_curvatures: [0.0; LANES],
            half_thicknesses: radii,
        }
    }

    /// The support of a piece: the furthest it reaches from its centre in a unit direction, in
    /// metres. For fields that bound one piece after the other.
    #[inline]
    pub fn support(&self, lane: usize, direction: Vec3) -> f32 {
        let radius = self.radii[lane];
        let across = direction.dot(self.normals.get(lane));
        let along = f32x4::splat((1.0 - across * across).max(0.0))
            .sqrt()
            .to_array()[0];
        let quadratic = across * self.half_curvatures[lane];
        // As in `rise`.
        let r = if quadratic < 0.0 {
            radius.min(along / (quadratic * -2.0))
        } else {
            radius
        };
        let on_paraboloid = across * self.apices[lane]
            + across.abs() * self.half_thicknesses[lane]
            + r * (along + quadratic * r);
        on_paraboloid.min(radius)
    }

    /// The pieces inflated to contain all points within `by` metres of their points.
    #[inline(always)]
    pub(crate) fn grown(&self, by: f32) -> Self {
        let radii = f32x4::new(self.radii);
        // A sideways step of `by` changes the height of the paraboloid by at most this.
        let aside = f32x4::new(self.half_curvatures).abs() * (radii + radii + by) * by;
        Self {
            radii: (radii + by).to_array(),
            half_thicknesses: (f32x4::new(self.half_thicknesses) + by + aside).to_array(),
            ..*self
        }
    }

    /// The most by which a linear function exceeds, in a piece, its value at the centre, given its
    /// gradient per metre, which is no longer than `steepest`.
    #[inline(always)]
    pub(crate) fn rise(&self, gradients: Vectors, steepest: f32x4) -> f32x4 {
        let normals = Vectors::from(self.normals);
        let radii = f32x4::new(self.radii);
        let across = gradients.dot(normals);
        let along = gradients.minus(normals.times(across)).length();
        // On the paraboloid the function is along r + quadratic r²: largest at the rim or at the vertex.
        let quadratic = across * f32x4::new(self.half_curvatures);
        let vertex = radii.fast_min(along / (quadratic * -2.0));
        let r = quadratic.simd_lt(f32x4::ZERO).select(vertex, radii);
        let on_paraboloid = across * f32x4::new(self.apices)
            + across.abs() * f32x4::new(self.half_thicknesses)
            + r * (along + quadratic * r);
        // At most its rise in the ball around.
        on_paraboloid.fast_min(steepest * radii)
    }
}
