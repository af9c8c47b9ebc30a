//! Force and torque integrated over a surface, the limit of infinitely many points.

use rapier3d::glamx::{DPose3, DVec3};
use vps_build::Mesh;

/// A surface cut into small pieces.
pub(super) struct SurfacePieces(Vec<Piece>);

struct Piece {
    middle: DVec3,
    /// The inward normal times the area of the piece, in m².
    inward: DVec3,
}

/// Least number of pieces.
const MIN_PIECES: usize = 150_000;

impl SurfacePieces {
    /// The pieces of a mesh, whose triangles are subdivided until there are enough.
    pub(super) fn of(mesh: &Mesh) -> Self {
        let mut fine = mesh.clone();
        while fine.triangles().len() < MIN_PIECES {
            fine = fine.subdivided();
        }
        let pieces = (0..fine.triangles().len()).map(|t| {
            let [a, b, c] = fine.corners(t);
            Piece {
                middle: (a + b + c) / 3.0,
                inward: 0.5 * (c - a).cross(b - a),
            }
        });
        Self(pieces.collect())
    }

    /// Force and torque about the origin of the body, both in its frame, in the half-space below
    /// height 0 for stiffness one: the integrals that eqs. 2 and 3 approach with area weights.
    pub(super) fn wrench(&self, pose: &DPose3) -> (DVec3, DVec3) {
        let up = pose.rotation.inverse() * DVec3::Y;
        let height = pose.translation.y;
        let mut sum = (DVec3::ZERO, DVec3::ZERO);
        for piece in &self.0 {
            let penetration = -(height + piece.middle.dot(up));
            if penetration > 0.0 {
                let force = penetration * piece.inward;
                sum.0 += force;
                sum.1 += piece.middle.cross(force);
            }
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By the divergence theorem a pressure that grows with depth exerts a force of the immersed
    /// volume, straight up.
    #[test]
    fn the_force_is_the_immersed_volume() {
        let (radius, depth) = (0.1, 0.03);
        let ball = SurfacePieces::of(&Mesh::icosphere(radius, 6).unwrap());
        let pose = DPose3::translation(0.0, radius - depth, 0.0);
        let (force, torque) = ball.wrench(&pose);
        let cap = std::f64::consts::PI * depth * depth * (radius - depth / 3.0);
        assert!((force.y / cap - 1.0).abs() < 1e-3, "{force} is not {cap}");
        assert!(torque.length() < 1e-6 * cap, "{torque}");
    }
}
