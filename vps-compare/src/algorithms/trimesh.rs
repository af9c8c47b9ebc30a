use rapier3d::parry::shape::SharedShape;

use crate::algorithm::{CollisionAlgorithm, PrepareError};
use crate::algorithms::parry_pair::parry_pair;
use crate::precision::single;
use crate::prepared::Prepared;
use crate::scene::Scene;

/// All triangles in a bounding volume hierarchy, as GImpact in the paper.
///
/// It has no interior: a body that is through the surface is not pushed back.
#[derive(Clone, Copy, Debug)]
pub struct Trimesh;

impl CollisionAlgorithm for Trimesh {
    fn prepare(&self, scene: &Scene<'_>) -> Result<Prepared, PrepareError> {
        parry_pair(scene, |mesh| {
            let triangles = mesh.triangles().to_vec();
            let size = vec![("triangles", triangles.len())];
            let shape = SharedShape::trimesh(single(mesh.vertices()), triangles)
                .map_err(|e| PrepareError::Trimesh(e.to_string()))?;
            Ok((shape, size))
        })
    }
}
