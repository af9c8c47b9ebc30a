use rapier3d::parry::shape::SharedShape;
use serde::{Deserialize, Serialize};

use crate::algorithm::{AssetSource, CollisionAlgorithm, PrepareError};
use crate::algorithms::parry_pair::parry_pair;
use crate::precision::single;
use crate::prepared::Prepared;
use crate::scene::Scene;

/// All triangles in a bounding volume hierarchy, as GImpact in the paper.
///
/// It has no interior: a body that is through the surface is not pushed back.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize)]
pub struct Trimesh;

impl CollisionAlgorithm for Trimesh {
    fn about(&self) -> &'static str {
        "The triangles"
    }

    fn label(&self) -> &'static str {
        "triangle mesh"
    }

    fn color(&self) -> [u8; 3] {
        [0x56, 0xb4, 0xe9]
    }

    fn prepare_with(
        &self,
        scene: &Scene<'_>,
        _assets: &AssetSource<'_>,
    ) -> Result<Prepared, PrepareError> {
        parry_pair(scene, |mesh| {
            let triangles = mesh.triangles().to_vec();
            let size = vec![("triangles", triangles.len())];
            let shape = SharedShape::trimesh(single(mesh.vertices()), triangles)
                .map_err(|e| PrepareError::Trimesh(e.to_string()))?;
            Ok((shape, size))
        })
    }
}
