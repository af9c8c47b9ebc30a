use rapier3d::parry::shape::SharedShape;

use crate::{CollisionAlgorithm, PrepareError, Prepared, Scene, parry_pair, single};

/// All triangles in a bounding volume hierarchy, as GImpact in the paper.
///
/// It has no interior: what is through the surface is not pushed back.
#[derive(Clone, Copy, Debug)]
pub struct Trimesh;

impl CollisionAlgorithm for Trimesh {
    fn prepare(&self, scene: &Scene<'_>) -> Result<Prepared, PrepareError> {
        let triangles = scene.body.triangles().to_vec();
        let count = triangles.len();
        let body = SharedShape::trimesh(single(scene.body.vertices()), triangles)
            .map_err(|e| PrepareError::Trimesh(e.to_string()))?;
        Ok(parry_pair(scene, body, vec![("triangles", count)]))
    }
}
