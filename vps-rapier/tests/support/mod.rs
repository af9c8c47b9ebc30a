//! Assets and states shared by the tests.

use std::sync::Arc;

use vps_build::{BuildOptions, Mesh, PointCount, Resolution, build};
use vps_core::Asset;
use vps_rapier::rapier3d::prelude::PhysicsWorld;

/// An asset of 40 voxels along its longest side.
#[allow(dead_code)]
pub(crate) fn asset(mesh: &Mesh, points: u32) -> Arc<Asset<'static>> {
    let options = BuildOptions {
        resolution: Resolution::VoxelsAlongLongest(40),
        points: PointCount::About(points),
        ..BuildOptions::default()
    };
    Arc::new(build(mesh, &options, &|_| ()).unwrap().asset)
}

/// All bits of the state of all bodies.
// Numbers of rapier are 32-bit or 64-bit.
#[allow(clippy::useless_conversion)]
#[allow(dead_code)] // Not every test uses it.
pub(crate) fn state(world: &PhysicsWorld) -> Vec<u64> {
    let mut bits = Vec::new();
    for (_, body) in world.bodies.iter() {
        let (place, turn) = (body.translation(), body.rotation());
        let numbers = [
            place.to_array(),
            body.linvel().to_array(),
            body.angvel().to_array(),
        ];
        bits.extend(
            numbers
                .as_flattened()
                .iter()
                .map(|n| f64::from(*n).to_bits()),
        );
        bits.extend(turn.to_array().map(|n| f64::from(n).to_bits()));
    }
    bits
}
