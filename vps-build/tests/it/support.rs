//! Random solids.

use proptest::prelude::*;
use vps_build::{BuildOptions, Density, Encoding, Mesh, PointCount, Resolution, build};
use vps_core::{Asset, Vec3};

/// Cases of a test: few in the usual run, more in the long run.
pub(crate) fn cases(usual: u32) -> ProptestConfig {
    let times = std::env::var("VPS_TEST_TIMES").map_or(1, |t| t.parse().unwrap());
    ProptestConfig::with_cases(usual * times)
}

/// A bumpy ball about 1 m across: closed, facing outwards, not convex.
pub(crate) fn bumpy_mesh() -> impl Strategy<Value = Mesh> {
    let bump = (direction(), -0.35..0.35_f64, 1.0..12.0_f64);
    prop::collection::vec(bump, 0..6).prop_map(|bumps| {
        let ball = Mesh::icosphere(0.5, 3).unwrap();
        let vertices: Vec<_> = ball
            .vertices()
            .iter()
            .map(|v| {
                let towards = v.normalize();
                let grow = |(d, height, width): &(Vec3, f64, f64)| {
                    height * (width * (towards.dot(d.as_dvec3()) - 1.0)).exp()
                };
                let height: f64 = bumps.iter().map(grow).sum();
                *v * (1.0 + height).max(0.2)
            })
            .collect();
        Mesh::new(&vertices, ball.triangles()).unwrap()
    })
}

pub(crate) fn asset(mesh: &Mesh, points: u32, encoding: Encoding) -> Asset<'static> {
    asset_of(mesh, points, encoding, Density::Sparse)
}

pub(crate) fn asset_of(
    mesh: &Mesh,
    points: u32,
    encoding: Encoding,
    density: Density,
) -> Asset<'static> {
    let options = BuildOptions {
        resolution: Resolution::VoxelsAlongLongest(18),
        margin: 5,
        points: PointCount::About(points),
        encoding,
        density,
        ..BuildOptions::default()
    };
    build(mesh, &options, &|_| ()).unwrap().asset
}

pub(crate) fn encoding() -> impl Strategy<Value = Encoding> {
    prop_oneof![
        3 => Just(Encoding::Distances(None)),
        1 => Just(Encoding::Distances(Some(2))),
        1 => Just(Encoding::Layers),
        1 => Just(Encoding::Floats),
    ]
}

pub(crate) fn density() -> impl Strategy<Value = Density> {
    prop_oneof![Just(Density::Sparse), Just(Density::Dense)]
}

pub(crate) fn vector(size: f32) -> impl Strategy<Value = Vec3> {
    prop::array::uniform3(-size..size).prop_map(Vec3::from_array)
}

pub(crate) fn direction() -> impl Strategy<Value = Vec3> {
    vector(1.0).prop_map(|v| v.normalize_or(Vec3::Y))
}
