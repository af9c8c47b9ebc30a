//! What measurements of queries have in common: the bunny and the ground of the paper's experiment.

use std::path::Path;

use vps_build::{BuildOptions, Density, Mesh, PointCount, Resolution, read_mesh};
use vps_core::{Cuboid, Vec3};

/// Edge lengths of the ground in metres.
pub(crate) const GROUND: [f64; 3] = [2.0, 0.2, 2.0];
/// Those of a box that holds a bunny as a whole.
pub(crate) const AROUND: [f64; 3] = [0.8; 3];
/// How many points the paper's fine bunny has.
pub(crate) const FINE: u32 = 35_596;

/// The bunny in metres, as `just fetch` brings it.
pub(crate) fn bunny() -> Mesh {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../.cache/models/bunny.obj");
    let bunny = read_mesh(&path, None).expect("the bunny: `just fetch` brings it");
    bunny.scaled(0.135).expect("a sound scale")
}

/// The exact box with these edges, around the origin.
pub(crate) fn cuboid(edges: [f64; 3]) -> Cuboid {
    Cuboid::new(Vec3::from_array(edges.map(|edge| 0.5 * edge as f32)))
}

/// How the bunny is built.
pub(crate) fn bunny_options(points: PointCount) -> BuildOptions {
    BuildOptions {
        resolution: Resolution::VoxelSize(0.00256),
        margin: 100,
        points,
        ..BuildOptions::default()
    }
}

/// How the ground is built; nobody asks for its points.
pub(crate) fn ground_options(density: Density) -> BuildOptions {
    BuildOptions {
        resolution: Resolution::VoxelSize(0.005),
        margin: 4,
        points: PointCount::About(10),
        density,
        ..BuildOptions::default()
    }
}
