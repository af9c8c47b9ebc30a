//! Pairs of parry's own shapes.

use std::sync::Arc;

use rapier3d::parry::query::DefaultQueryDispatcher;
use rapier3d::parry::shape::SharedShape;
use vps_build::Mesh;

use crate::algorithm::PrepareError;
use crate::memory::Memory;
use crate::prepared::{Prepared, Size};
use crate::scene::{Ground, Scene};

/// A pair of parry's own shapes, each made of its mesh in the same way.
pub(super) fn parry_pair(
    scene: &Scene<'_>,
    make: impl Fn(&Mesh) -> Result<(SharedShape, Size), PrepareError>,
) -> Result<Prepared, PrepareError> {
    let (body, size) = make(scene.body)?;
    let (ground, ground_size) = match scene.ground {
        Ground::Cuboid(extents) => (cuboid(extents), Size::new()),
        Ground::Mesh(mesh) => make(mesh)?,
    };
    Ok(Prepared {
        memory: Memory::of_parry(&*body).and(Memory::of_parry(&*ground)),
        body,
        ground,
        dispatcher: Arc::new(DefaultQueryDispatcher),
        size,
        ground_size,
    })
}

/// A cuboid by its edge lengths.
pub(super) fn cuboid(extents: [f64; 3]) -> SharedShape {
    let [x, y, z] = extents.map(|e| 0.5 * e as f32);
    SharedShape::cuboid(x, y, z)
}
