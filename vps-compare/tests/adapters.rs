//! Every algorithm on scenes whose answers are known.

use glamx::DVec3;
use rapier3d::math::Pose;
use vps_build::Mesh;
use vps_compare::oracle::PlaneOracle;
use vps_compare::{
    Algorithm, Ball, CollisionAlgorithm, Contacts, Ground, PrepareError, Scene, Sizes, Vps,
};

/// All algorithms at the sizes of these tests, with their keys, and VPS on a box that is a voxelmap.
fn algorithms() -> Vec<(&'static str, Algorithm)> {
    let sizes = Sizes {
        points: 2000,
        voxels: 60,
        parts: 4,
    };
    let mut all = Algorithm::all();
    all.push(Algorithm::Vps(Vps {
        ground_voxel_size_m: Some(0.01),
        ..Vps::default()
    }));
    for algorithm in &mut all {
        algorithm.set_sizes(&sizes);
        match algorithm {
            Algorithm::Vps(vps) => vps.voxel_size_m = Some(0.01),
            Algorithm::VpsBoth(vps) => vps.0.voxel_size_m = Some(0.01),
            Algorithm::ConvexDecomposition(decomposition) => decomposition.resolution = 32,
            _ => {}
        }
    }
    all.into_iter().map(|a| (a.key(), a)).collect()
}

#[test]
fn all_find_a_ball_on_a_box() {
    let ball = Mesh::icosphere(0.1, 3).unwrap();
    let scene = Scene {
        body: &ball,
        ground: Ground::Cuboid([1.0, 0.2, 1.0]),
    };
    // The tolerance of each: of its hull, its spacing or its voxels.
    let tolerance = |key: &str| match key {
        "vps" | "vps_both" => 0.001,
        "convex_hull" => 0.004,
        "convex_decomposition" => 0.003,
        "trimesh" => 1e-5,
        // The diagonal of a voxel.
        _ => 0.006,
    };
    let oracle = PlaneOracle::new(&ball).unwrap();
    for (key, algorithm) in algorithms() {
        let prepared = algorithm.prepare(&scene).unwrap();
        assert!(prepared.size.iter().all(|(_, n)| *n > 0));
        let mut contacts = Contacts::default();
        for height in [0.5, 0.25, 0.205, 0.199, 0.19] {
            let pose = Pose::translation(0.05, height, 0.0);
            prepared.query(&pose, 0.01, &mut contacts).unwrap();
            let (count, deepest) = contacts.count_and_deepest();
            let exact = oracle.penetration(&pose, 0.1);
            if exact < -0.02 {
                assert!(deepest.is_none_or(|d| d < 0.0), "{key} at {height}");
            } else {
                let deepest = deepest.unwrap();
                assert!(count > 0);
                assert!(
                    (deepest - exact).abs() < tolerance(key),
                    "{key}: {deepest}, exact {exact}"
                );
            }
        }
    }
}

/// Two balls as meshes, which touch at a distance of 0.2.
#[test]
fn all_find_a_ball_on_a_ball() {
    let ball = Mesh::icosphere(0.1, 3).unwrap();
    let scene = Scene {
        body: &ball,
        ground: Ground::Mesh(&ball),
    };
    let tolerance = |key: &str| match key {
        "vps" | "vps_both" => 0.002,
        "convex_decomposition" => 0.006,
        // Triangles have no depth; a pair of them is pushed apart as it stands.
        "trimesh" => 0.004,
        _ => 0.012,
    };
    for (key, algorithm) in algorithms() {
        let prepared = algorithm.prepare(&scene).unwrap();
        assert_eq!(prepared.size, prepared.ground_size);
        let is_small = prepared.body.as_ball().is_some();
        assert!(is_small || prepared.memory.bytes > 1000, "{key}");
        // Between voxels parry reports touches away from the cubes of either.
        if key == "voxels" {
            continue;
        }
        for distance in [0.5, 0.205, 0.199, 0.195] {
            let pose = Pose::translation(0.0, 0.6 * distance, 0.8 * distance);
            let mut contacts = Contacts::default();
            prepared.query(&pose, 0.02, &mut contacts).unwrap();
            let deepest = contacts.count_and_deepest().1;
            if distance > 0.3 {
                assert_eq!(deepest, None, "{key}");
            } else {
                let off = deepest.unwrap() - (0.2 - distance);
                assert!(off.abs() < tolerance(key), "{key} at {distance}: {off}");
            }
        }
    }
}

#[test]
fn a_torus_is_not_a_ball() {
    let scene = Scene {
        body: &Mesh::icosphere(0.1, 3).unwrap(),
        ground: Ground::Mesh(&vps_build::models::torus(12)),
    };
    let prepared = Ball.prepare(&scene).map(|_| ());
    assert_eq!(prepared, Err(PrepareError::NotABall));
}

#[test]
fn a_mesh_far_from_its_origin_is_refused() {
    let ball = Mesh::icosphere(0.1, 2).unwrap();
    let vertices: Vec<_> = ball
        .vertices()
        .iter()
        .map(|v| *v + DVec3::splat(1e5))
        .collect();
    let far = Mesh::new(&vertices, ball.triangles()).unwrap();
    let scene = Scene {
        body: &far,
        ground: Ground::Mesh(&ball),
    };
    let prepared = Vps::default().prepare(&scene);
    assert_eq!(prepared.err(), Some(PrepareError::FarFromOrigin));
}
