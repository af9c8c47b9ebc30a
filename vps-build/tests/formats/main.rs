//! A few files of each version of the format, which all later versions go on reading.

use std::path::{Path, PathBuf};

use vps_build::{
    BuildOptions, Density, Encoding, PointCount, Resolution, build, models, read_asset, write_asset,
};
use vps_core::{Cuboid, DistanceField, Pose3, Query, VPS_VERSION, Vec3};

const CHANGED: &str = "The format has changed. Keep this file and make the new version read it. For \
    the files of the new version, raise VPS_VERSION, run `cargo test -p vps-build --test formats -- \
    --ignored`, and add them to PINNED beside the old ones.";

/// A file in `tests/formats` of a torus, and the results of queries on it.
struct Pinned {
    version: u64,
    name: &'static str,
    points: usize,
    /// Penetration of the deepest point in metres, [`lying`] on the ground.
    deepest: f32,
    /// Penetration in metres at each of [`SAMPLES`].
    samples: [f32; SAMPLES.len()],
}

const PINNED: [Pinned; 3] = [
    Pinned {
        version: 5,
        name: "dense_layers",
        points: 200,
        deepest: 0.02,
        samples: [0.083333336, -0.0029167365, -0.115833364, -1.9202412],
    },
    Pinned {
        version: 5,
        name: "sparse_distances",
        points: 200,
        deepest: 0.02,
        samples: [0.12611999, -0.0019960944, -0.16727103, -1.9486338],
    },
    Pinned {
        version: 5,
        name: "sparse_floats",
        points: 200,
        deepest: 0.02,
        samples: [0.12621295, -0.0020038998, -0.16729668, -1.9486439],
    },
];

/// In the tube, at its surface, in the hole, and outside of the grid.
const SAMPLES: [Vec3; 4] = [
    Vec3::new(0.35, 0.0, 0.0),
    Vec3::new(0.3, 0.4, 0.01),
    Vec3::new(0.02, -0.03, 0.05),
    Vec3::new(0.5, 1.0, -2.0),
];

/// Tolerance of values in metres.
const TOLERANCE: f32 = 1e-5;

/// Largest distance of the faces of the mesh from a torus, in metres.
const FACETS: f32 = 1e-3;

fn path(version: u64, name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/formats");
    folder.join(format!("{version}_{name}.vps"))
}

/// The top of the ground is 0.1 m above its middle; the torus reaches 2 cm into it.
fn lying() -> (Cuboid, Pose3) {
    let ground = Cuboid::new(Vec3::new(2.0, 2.0, 0.1));
    let pose = Pose3::from_translation(Vec3::new(0.0, 0.0, 0.1 + 0.15 - 0.02));
    (ground, pose)
}

/// Penetration of a point in the torus of all files.
fn exact(p: Vec3) -> f32 {
    let from_middle = Vec3::new(p.truncate().length() - 0.35, p.z, 0.0);
    0.15 - from_middle.length()
}

#[test]
fn files_of_every_version_are_read() {
    for pinned in &PINNED {
        let path = path(pinned.version, pinned.name);
        let asset = read_asset(&path).unwrap_or_else(|e| panic!("{e}. {CHANGED}"));
        let context = format!("{}. {CHANGED}", path.display());
        let field = asset.voxelmap.trilinear();
        let (ground, pose) = lying();
        let query = Query::new(&asset.tree, &ground, pose);
        let deepest = query.deepest().map_or(0.0, |contact| contact.penetration);
        let samples = SAMPLES.map(|p| -field.signed_distance(p));
        let found = format!(
            "points: {}, deepest: {deepest}, samples: {samples:?}",
            asset.tree.point_count()
        );
        let is_near = |a: f32, b: f32| (a - b).abs() <= TOLERANCE;
        assert!(
            asset.tree.point_count() == pinned.points
                && is_near(deepest, pinned.deepest)
                && samples
                    .iter()
                    .zip(pinned.samples)
                    .all(|(a, b)| is_near(*a, b)),
            "{found} in {context}"
        );
        // The values are those of a torus, and not only those of the day they were pinned.
        for (p, sample) in SAMPLES.into_iter().zip(samples) {
            let bound = field.error_bound_at(p) + FACETS;
            assert!(
                (sample - exact(p)).abs() <= bound,
                "{p}: {sample}, not {} to within {bound}, in {context}",
                exact(p)
            );
        }
        if pinned.version == VPS_VERSION {
            let bytes = std::fs::read(&path).unwrap();
            assert!(
                asset.to_bytes() == bytes,
                "today it would be written with other bytes: {context}"
            );
        }
    }
}

#[test]
fn files_of_this_version_are_pinned() {
    let is_of_this_version = |pinned: &&Pinned| pinned.version == VPS_VERSION;
    let count = PINNED.iter().filter(is_of_this_version).count();
    assert!(count > 0, "version {VPS_VERSION} has no file. {CHANGED}");
}

/// Writes the files of the current version that are missing.
#[test]
#[ignore = "writes into the sources"]
fn pin_this_version() {
    for (name, encoding, density) in [
        ("dense_layers", Encoding::Layers, Density::Dense),
        (
            "sparse_distances",
            Encoding::Distances(None),
            Density::Sparse,
        ),
        ("sparse_floats", Encoding::Floats, Density::Sparse),
    ] {
        let path = path(VPS_VERSION, name);
        if path.exists() {
            continue;
        }
        let options = BuildOptions {
            resolution: Resolution::VoxelsAlongLongest(24),
            points: PointCount::About(200),
            encoding,
            density,
            ..BuildOptions::default()
        };
        let built = build(&models::torus(96), &options, &|_| ()).unwrap();
        write_asset(&path, &built.asset).unwrap();
    }
}
