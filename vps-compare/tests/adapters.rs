//! Every adapter on one scene whose answers are known.

use std::sync::Arc;

use rapier3d::math::Pose;
use vps_build::{BuildOptions, Mesh, PointCount, Resolution, build};
use vps_compare::{
    CollisionAlgorithm, Contacts, ConvexDecomposition, ConvexHull, Ground, PrepareError, Scene,
    Trimesh, Voxels, Vps, VpsGround, oracle::PlaneOracle,
};
use vps_rapier::{Manifolds, Role, Sampling};

#[test]
fn all_find_a_ball_on_a_box() {
    let ball = Mesh::icosphere(0.1, 3).unwrap();
    let scene = Scene {
        body: &ball,
        ground: Ground::Cuboid([1.0, 0.2, 1.0]),
    };
    let options = |points| BuildOptions {
        resolution: Resolution::VoxelSize(0.01),
        points: PointCount::About(points),
        ..BuildOptions::default()
    };
    let assets = |mesh: &Mesh, options: &BuildOptions| {
        let asset = build(mesh, options, &|_| ())
            .map_err(|e| e.to_string())?
            .asset;
        Ok(Arc::new(asset))
    };
    let vps = |ground| Vps {
        body: options(2000),
        ground,
        sampling: Sampling::Trilinear,
        manifolds: Manifolds::Reduced,
        assets: &assets,
    };
    let decomposition = ConvexDecomposition {
        parts: 4,
        vertices: 100,
        resolution: 32,
    };
    let algorithms: [(&dyn CollisionAlgorithm, f32); 6] = [
        // The tolerance of each: of its hull, its spacing or its voxels.
        (&vps(VpsGround::Cuboid), 0.001),
        (&vps(VpsGround::Voxelmap(options(10))), 0.001),
        (&ConvexHull, 0.004),
        (&decomposition, 0.003),
        (&Trimesh, 1e-5),
        // The diagonal of a voxel.
        (&Voxels { resolution: 60 }, 0.006),
    ];
    let oracle = PlaneOracle::new(&ball).unwrap();
    for (i, (algorithm, tolerance)) in algorithms.into_iter().enumerate() {
        let prepared = algorithm.prepare(&scene).unwrap();
        assert!(prepared.size.iter().all(|(_, n)| *n > 0));
        let mut contacts = Contacts::default();
        for height in [0.5, 0.25, 0.205, 0.199, 0.19] {
            let pose = Pose::translation(0.05, height, 0.0);
            prepared.query(&pose, 0.01, &mut contacts).unwrap();
            let (count, deepest) = contacts.count_and_deepest();
            let exact = oracle.penetration(&pose, 0.1);
            if exact < -0.02 {
                assert!(deepest.is_none_or(|d| d < 0.0), "algorithm {i} at {height}");
            } else {
                let deepest = deepest.unwrap();
                assert!(count > 0);
                assert!(
                    (deepest - exact).abs() < tolerance,
                    "algorithm {i}: {deepest}, exact {exact}"
                );
            }
        }
    }
}

/// Two balls as meshes, which touch at a distance of 0.2.
#[test]
fn all_find_a_ball_on_a_ball() {
    let ball = Mesh::icosphere(0.1, 3).unwrap();
    let options = BuildOptions {
        resolution: Resolution::VoxelSize(0.01),
        points: PointCount::About(2000),
        ..BuildOptions::default()
    };
    let assets = |mesh: &Mesh, options: &BuildOptions| {
        let built = build(mesh, options, &|_| ()).map_err(|e| e.to_string())?;
        Ok(Arc::new(built.asset))
    };
    let vps = |ground| Vps {
        body: options.clone(),
        ground,
        sampling: Sampling::Trilinear,
        manifolds: Manifolds::Reduced,
        assets: &assets,
    };
    let decomposition = ConvexDecomposition {
        parts: 4,
        vertices: 100,
        resolution: 32,
    };
    let algorithms: [(&dyn CollisionAlgorithm, f32); 6] = [
        (&vps(VpsGround::Voxelmap(options.clone())), 0.002),
        (&vps(VpsGround::Asset(options.clone(), Role::Mixed)), 0.002),
        (&vps(VpsGround::Asset(options.clone(), Role::Both)), 0.002),
        (&ConvexHull, 0.012),
        (&decomposition, 0.006),
        // Triangles have no depth; a pair of them is pushed apart as it stands.
        (&Trimesh, 0.004),
    ];
    let scene = Scene {
        body: &ball,
        ground: Ground::Mesh(&ball),
    };
    for (i, (algorithm, tolerance)) in algorithms.into_iter().enumerate() {
        let prepared = algorithm.prepare(&scene).unwrap();
        assert_eq!(prepared.size, prepared.ground_size);
        assert!(prepared.memory().bytes > 1000, "algorithm {i}");
        for distance in [0.5, 0.205, 0.199, 0.195] {
            let pose = Pose::translation(0.0, 0.6 * distance, 0.8 * distance);
            let mut contacts = Contacts::default();
            prepared.query(&pose, 0.02, &mut contacts).unwrap();
            let deepest = contacts.count_and_deepest().1;
            if distance > 0.3 {
                assert_eq!(deepest, None, "algorithm {i}");
            } else {
                let off = deepest.unwrap() - (0.2 - distance);
                assert!(off.abs() < tolerance, "algorithm {i} at {distance}: {off}");
            }
        }
    }
    let exact = vps(VpsGround::Cuboid).prepare(&scene).map(|_| ());
    assert_eq!(exact, Err(PrepareError::NotACuboid));
}
