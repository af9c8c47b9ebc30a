//! Local frames of the meshes. Shapes and poses of parry hold 32-bit numbers, which are too coarse far
//! from the origin, where maps are.

use glamx::{DPose3, DVec3};
use rapier3d::math::Pose;
use vps_build::{Mesh, MeshError};

/// The local frames of A and B: their origins in the frames of the meshes, in metres.
#[derive(Clone, Copy)]
pub(super) struct Frames(pub(super) [DVec3; 2]);

/// A and B in local frames, in metres.
pub(super) struct LocalMeshes {
    pub(super) a: Mesh,
    pub(super) b: Mesh,
    pub(super) frames: Frames,
}

impl LocalMeshes {
    pub(super) fn of([a, b]: [Mesh; 2]) -> Result<Self, MeshError> {
        let frames = Frames([origin(&a), origin(&b)]);
        Ok(Self {
            a: to_local(a, frames.0[0])?,
            b: to_local(b, frames.0[1])?,
            frames,
        })
    }
}

/// The centre of a mesh, to within a quarter of its longest side. A multiple of a power of two has few
/// digits, so that subtracting it loses almost nothing; for a mesh about its origin it is zero.
fn origin(mesh: &Mesh) -> DVec3 {
    let (low, high) = mesh.bounds();
    let step = (0.5 * (high - low).max_element()).log2().floor().exp2();
    (low.midpoint(high) / step).round() * step
}

fn to_local(mesh: Mesh, origin: DVec3) -> Result<Mesh, MeshError> {
    if origin == DVec3::ZERO {
        return Ok(mesh);
    }
    let vertices: Vec<_> = mesh.vertices().iter().map(|&v| v - origin).collect();
    Mesh::new(&vertices, mesh.triangles())
}

impl Frames {
    /// The pose of B in A between the local frames, given that between the meshes.
    pub(super) fn to_local(self, pose: &DPose3) -> Pose {
        let Self([a, b]) = self;
        let translation = pose.translation + pose.rotation * b - a;
        Pose::from_parts(translation.as_vec3(), pose.rotation.as_quat())
    }

    /// The pose of B in A between the meshes, given that between the local frames.
    pub(super) fn to_meshes(self, pose: &Pose) -> DPose3 {
        let Self([a, b]) = self;
        // Far away, a length of 32 bits would be felt.
        let rotation = pose.rotation.as_dquat().normalize();
        let translation = pose.translation.as_dvec3() + a - rotation * b;
        DPose3::from_parts(translation, rotation)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glamx::DQuat;

    #[test]
    fn a_far_box_comes_near_and_one_about_its_origin_stays() {
        let far = DVec3::new(5e5 + 0.3, -5e6, 7.0);
        let cuboid = Mesh::cuboid([1.0, 2.0, 0.5]).unwrap();
        let vertices: Vec<_> = cuboid.vertices().iter().map(|&v| v + far).collect();
        let far_box = Mesh::new(&vertices, cuboid.triangles()).unwrap();
        let (low, _) = far_box.bounds();
        let local = LocalMeshes::of([far_box, cuboid]).unwrap();
        let Frames([a, b]) = local.frames;
        assert_eq!(b, DVec3::ZERO);
        assert_eq!(local.a.bounds().0 + a, low);
        assert!((far - a).abs().max_element() <= 0.5);
        let rotation = DQuat::from_scaled_axis(DVec3::new(0.3, -1.0, 0.2));
        let pose = DPose3::from_parts(far + DVec3::new(0.1, 0.2, 0.3), rotation);
        let there = local.frames.to_local(&pose);
        assert!((there.translation.as_dvec3() - (pose.translation - a)).length() < 1e-7);
        // Both far: between the meshes and back.
        let frames = Frames([far, -far]);
        let back = frames.to_local(&frames.to_meshes(&there));
        assert!((back.translation - there.translation).length() < 1e-6);
        assert!(back.rotation.angle_between(there.rotation) < 1e-3);
    }
}
