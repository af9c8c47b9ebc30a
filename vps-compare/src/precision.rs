//! Conversion to the precision of rapier and parry.

use glamx::DVec3;
use rapier3d::math::Vector;

/// Vertices in 32 bits.
pub(crate) fn single(vertices: &[DVec3]) -> Vec<Vector> {
    vertices.iter().map(|v| v.as_vec3()).collect()
}
