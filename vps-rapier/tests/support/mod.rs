//! What tests of worlds and pairs are made of.

use std::sync::Arc;

use vps_build::{BuildOptions, Mesh, PointCount, Resolution, build};
use vps_core::Asset;

/// An asset of 40 voxels along its longest side.
pub(crate) fn asset(mesh: &Mesh, points: u32) -> Arc<Asset<'static>> {
    let options = BuildOptions {
        resolution: Resolution::VoxelsAlongLongest(40),
        points: PointCount::About(points),
        ..BuildOptions::default()
    };
    Arc::new(build(mesh, &options, &|_| ()).unwrap().asset)
}
