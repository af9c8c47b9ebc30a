use rapier3d::parry::shape::SharedShape;
use serde::{Deserialize, Serialize};

use crate::algorithm::{AssetSource, CollisionAlgorithm, PrepareError};
use crate::algorithms::parry_pair::parry_pair;
use crate::prepared::{Prepared, Size};
use crate::scene::Scene;

/// The ball of parry, for the mesh of a ball around its origin.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize)]
pub struct Ball;

/// How far vertices may be from the ball, relative to its radius.
const ROUNDNESS_TOLERANCE: f64 = 0.001;

impl CollisionAlgorithm for Ball {
    fn about(&self) -> &'static str {
        "An exact ball, for meshes of balls around their origins"
    }

    fn label(&self) -> &'static str {
        "ball of rapier"
    }

    fn color(&self) -> [u8; 3] {
        [0xf0, 0xe4, 0x42]
    }

    fn is_in_default_set(&self) -> bool {
        false
    }

    fn prepare_with(
        &self,
        scene: &Scene<'_>,
        _assets: &AssetSource<'_>,
    ) -> Result<Prepared, PrepareError> {
        parry_pair(scene, |mesh| {
            let radii = || mesh.vertices().iter().map(|v| v.length());
            let radius = radii().fold(0.0, f64::max);
            if radii().any(|r| r < (1.0 - ROUNDNESS_TOLERANCE) * radius) {
                return Err(PrepareError::NotABall);
            }
            Ok((SharedShape::ball(radius as f32), Size::new()))
        })
    }
}
