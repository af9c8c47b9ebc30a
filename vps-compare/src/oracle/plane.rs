use rapier3d::math::{Pose, Vector};
use rapier3d::parry::transformation::try_convex_hull;
use vps_build::Mesh;

use crate::algorithm::PrepareError;
use crate::precision::single;

/// Exact depth of a mesh below a plane: the lowest point is always a vertex of the convex hull.
#[derive(Clone, Debug)]
pub struct PlaneOracle {
    hull: Vec<Vector>,
}

impl PlaneOracle {
    /// An oracle for a mesh.
    ///
    /// # Errors
    /// When the mesh has no volume.
    pub fn new(mesh: &Mesh) -> Result<Self, PrepareError> {
        let no_volume = |_| PrepareError::NoVolume("convex hull");
        let (hull, _) = try_convex_hull(&single(mesh.vertices())).map_err(no_volume)?;
        Ok(Self { hull })
    }

    /// Penetration in metres of the posed mesh in the half-space below the height `plane_y`,
    /// negative when it is above.
    pub fn penetration(&self, pose: &Pose, plane_y: f32) -> f32 {
        let lowest = self
            .hull
            .iter()
            .map(|p| (*pose * *p).y)
            .fold(f32::INFINITY, f32::min);
        plane_y - lowest
    }
}
