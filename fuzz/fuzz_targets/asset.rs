//! The reader of .vps files accepts any bytes without a panic, and so do queries on the assets it returns.

#![no_main]

use libfuzzer_sys::fuzz_target;
use vps_core::{Asset, Pose3, Query, Vec3, Weight};
use xxhash_rust::xxh3::xxh3_64;

fuzz_target!(|bytes: &[u8]| {
    // With the right checksum: otherwise nothing but the check would be tested. An allocation of
    // its own lies at a multiple of 8.
    let mut aligned = bytes.to_vec();
    if aligned.len() > 24 {
        let checksum = xxh3_64(&aligned[24..]).to_le_bytes();
        aligned[16..24].copy_from_slice(&checksum);
    }
    let Ok(asset) = Asset::from_bytes(&aligned) else {
        return;
    };
    let map = &asset.voxelmap;
    let (trilinear, local) = (map.trilinear(), map.local());
    let bounds = map.grid().bounds();
    for pose in [
        Pose3::IDENTITY,
        Pose3::from_translation(bounds.extents() * 0.5),
        Pose3::from_translation(Vec3::splat(1e30)),
    ] {
        let query = Query::new(&asset.tree, &trilinear, pose);
        query.for_each_contact(|_| ());
        let _ = query.with_prediction(0.1).wrench(Vec3::ZERO, Weight::Area);
        let _ = Query::new(&asset.tree, &local, pose).deepest();
    }
    let [x, y, z] = map.grid().dims().map(|n| n - 1);
    let _ = map.center_penetration([x, y, z]);
});
