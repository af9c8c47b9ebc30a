//! The local frame of an asset.
//!
//! An asset holds 32-bit numbers. If the mesh is so far from its origin that they would lose more
//! than a thousandth of a voxel, the asset gets a frame of its own at the centre of the mesh.

use std::borrow::Cow;

use glamx::DVec3;

use super::Mesh;

/// Largest rounding of a coordinate to 32 bits, in voxels.
const MAX_ROUNDING: f64 = 1e-3;

/// Half a unit in the last place of a 32-bit number, relative to it.
const HALF_STEP: f64 = 0.5 * f32::EPSILON as f64;

/// The mesh in the local frame, and the origin of that frame in mesh coordinates.
pub(crate) fn to_local(mesh: &Mesh, voxel_size: f64) -> (Cow<'_, Mesh>, DVec3) {
    let origin = origin(mesh.bounds(), voxel_size);
    if origin == DVec3::ZERO {
        return (Cow::Borrowed(mesh), origin);
    }
    (Cow::Owned(mesh.translated(-origin)), origin)
}

fn origin((low, high): (DVec3, DVec3), voxel_size: f64) -> DVec3 {
    let largest = low.abs().max(high.abs()).max_element();
    if largest * HALF_STEP < MAX_ROUNDING * voxel_size {
        return DVec3::ZERO;
    }
    // A multiple of a power of two has few digits, so that subtracting it loses almost nothing.
    let step = voxel_size.log2().floor().exp2();
    (low.midpoint(high) / step).round() * step
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_meshes_stay_and_far_ones_come_to_the_middle() {
        let bounds = |at: DVec3| (at - 1.0, at + DVec3::new(1.0, 2.0, 3.0));
        assert_eq!(origin(bounds(DVec3::X * 300.0), 0.02), DVec3::ZERO);
        for at in [DVec3::new(5e5 + 0.3, -5e6, 7.0), DVec3::splat(400.0)] {
            let (low, high) = bounds(at);
            let origin = origin((low, high), 0.02);
            let off = (low.midpoint(high) - origin).abs();
            assert!(off.max_element() <= 0.01, "{off}");
            // Nothing is lost.
            assert_eq!(low - origin + origin, low);
            assert_eq!((origin * 64.0).fract(), DVec3::ZERO);
        }
    }
}
