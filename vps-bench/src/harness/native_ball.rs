//! The native ball of the engine.

use std::sync::Arc;

use rapier3d::parry::query::DefaultQueryDispatcher;
use rapier3d::parry::shape::SharedShape;
use vps_compare::{CollisionAlgorithm, Ground, PrepareError, Prepared, Scene, Size};

/// A ball in place of a mesh of one around its origin, on an exact box.
pub(super) struct NativeBall;

impl CollisionAlgorithm for NativeBall {
    fn prepare(&self, scene: &Scene<'_>) -> Result<Prepared, PrepareError> {
        let Ground::Cuboid(extents) = scene.ground else {
            return Err(PrepareError::NotACuboid);
        };
        let vertices = scene.body.vertices();
        let radius = vertices.iter().map(|v| v.length()).fold(0.0, f64::max);
        let [x, y, z] = extents.map(|e| 0.5 * e as f32);
        Ok(Prepared {
            body: SharedShape::ball(radius as f32),
            ground: SharedShape::cuboid(x, y, z),
            dispatcher: Arc::new(DefaultQueryDispatcher),
            size: Size::new(),
            ground_size: Size::new(),
        })
    }
}
