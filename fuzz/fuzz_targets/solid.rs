//! The builder makes an asset of any triangles, or says why not.

#![no_main]

use glamx::DVec3;
use libfuzzer_sys::fuzz_target;
use vps_build::{
    BuildOptions, ClosestPoints, Density, Encoding, Mesh, PointCount, Resolution, Sign, build,
};
use vps_core::Asset;

fuzz_target!(|bytes: &[u8]| {
    let [choice, count, rest @ ..] = bytes else {
        return;
    };
    let count = usize::from(count % 24) + 3;
    let Some((vertices, triangles)) = rest.split_at_checked(3 * count) else {
        return;
    };
    // On a coarse lattice, so that much coincides.
    let vertices: Vec<_> = vertices
        .chunks_exact(3)
        .map(|c| DVec3::new(f64::from(c[0]), f64::from(c[1] % 16), f64::from(c[2] % 8)))
        .collect();
    let triangles: Vec<_> = triangles
        .chunks_exact(3)
        .take(64)
        .map(|t| [t[0], t[1], t[2]].map(|v| u32::from(v) % count as u32))
        .collect();
    let Ok(mesh) = Mesh::new(&vertices, &triangles) else {
        return;
    };
    let pick = |shift: u32, of: u8| (choice >> shift) % of;
    let options = BuildOptions {
        resolution: Resolution::VoxelsAlongLongest(12),
        margin: 2,
        points: PointCount::About(20),
        sign: [Sign::Auto, Sign::Winding, Sign::Generalized, Sign::Fill][usize::from(pick(0, 4))],
        density: [Density::Dense, Density::Sparse][usize::from(pick(2, 2))],
        closest_points: [ClosestPoints::Exact, ClosestPoints::GradientDescent]
            [usize::from(pick(3, 2))],
        encoding: [
            Encoding::Distances(None),
            Encoding::Layers,
            Encoding::Floats,
        ][usize::from(pick(4, 3))],
        ..BuildOptions::default()
    };
    if let Ok(built) = build(&mesh, &options, &|_| ()) {
        let bytes = built.asset.to_bytes();
        Asset::from_bytes(&bytes).expect("an asset that was built can be read");
    }
});
