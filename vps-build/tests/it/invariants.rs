//! Invariants of any mesh and any pose.

use crate::brute_force::exact_penetration;
use crate::support::{asset, bumpy_mesh, cases, encoding};
use glamx::DVec3;
use proptest::prelude::*;
use vps_build::{
    BuildOptions, ClosestPoints, Clustering, Density, Encoding, Mesh, PointCount, Resolution, build,
};

fn clustering() -> impl Strategy<Value = Clustering> {
    prop_oneof![
        Just(Clustering::Bisect),
        any::<u64>().prop_map(|seed| Clustering::BottomUp { seed }),
    ]
}

proptest! {
    #![proptest_config(cases(48))]

    /// Counted explicitly, besides the validation of the tree.
    #[test]
    fn points_lie_in_one_leaf_and_in_all_balls_above(
        mesh in bumpy_mesh(), points in 1..900_u32, branching in 2..20_u32, clustering in clustering(),
    ) {
        let options = BuildOptions {
            resolution: Resolution::VoxelsAlongLongest(12),
            points: PointCount::About(points),
            branching,
            clustering,
            ..BuildOptions::default()
        };
        let tree = build(&mesh, &options, &|_| ()).unwrap().asset.tree;
        let mut leaves_of = vec![0; tree.point_count()];
        for level in 1..=tree.level_count() {
            let mut seen = vec![0; tree.point_count()];
            for cluster in tree.level(level) {
                let center = cluster.center();
                for p in tree.points_below(level, cluster) {
                    seen[p] += 1;
                    prop_assert!(center.distance(tree.point(p)) <= cluster.radius());
                }
            }
            prop_assert!(seen.iter().all(|&n| n == 1));
        }
        for leaf in tree.level(tree.level_count()) {
            for p in leaf.children() {
                leaves_of[p as usize] += 1;
            }
        }
        prop_assert!(leaves_of.iter().all(|&n| n == 1));
        prop_assert_eq!(tree.level(1).len(), 1);
    }

    #[test]
    fn voxel_values_are_within_their_error(
        mesh in bumpy_mesh(), encoding in encoding(), is_dense in any::<bool>(),
        by_descent in prop::bool::weighted(0.2),
        at in prop::collection::vec(prop::array::uniform3(any::<prop::sample::Index>()), 200),
    ) {
        let options = BuildOptions {
            resolution: Resolution::VoxelsAlongLongest(22),
            margin: 12,
            points: PointCount::About(10),
            encoding,
            density: if is_dense { Density::Dense } else { Density::Sparse },
            closest_points: if by_descent { ClosestPoints::GradientDescent } else { ClosestPoints::Exact },
            ..BuildOptions::default()
        };
        let asset = build(&mesh, &options, &|_| ()).unwrap().asset;
        let map = &asset.voxelmap;
        prop_assert_eq!(map.store().is_dense(), is_dense);
        let error_bounds = map.error_bounds();
        if !by_descent && encoding != Encoding::Layers && map.sigma() < 0.5 * map.grid().voxel_size() {
            prop_assert!(error_bounds.beyond <= 1.0001 * map.grid().voxel_size());
        }
        let dims = map.grid().dims();
        for at in at {
            let voxel = [0, 1, 2].map(|a| at[a].index(dims[a] as usize) as u32);
            let stored = map.center_penetration(voxel);
            let exact = exact_penetration(&mesh, map.grid().center(voxel).as_dvec3()) as f32;
            let off = (stored - exact).abs();
            if stored.abs() <= error_bounds.narrow_band {
                prop_assert!(off <= error_bounds.in_band, "{voxel:?}: {stored}, exact {exact}");
            } else {
                prop_assert!(off <= error_bounds.beyond, "{voxel:?}: {stored}, exact {exact}");
            }
        }
    }

    /// Points keep their spacing, and every position on the surface has one near. A candidate is
    /// within the diagonal of a sampling voxel, √3 / √2 of the spacing, and the point that rejected
    /// it is within the spacing of it.
    #[test]
    fn points_are_spread_evenly(
        mesh in bumpy_mesh(), spacing in 0.04..0.15_f64,
        at in prop::collection::vec((0..1280_usize, 0.0..1.0_f64, 0.0..1.0_f64), 60),
    ) {
        let options = BuildOptions {
            resolution: Resolution::VoxelsAlongLongest(20),
            points: PointCount::Spacing(spacing),
            ..BuildOptions::default()
        };
        let tree = build(&mesh, &options, &|_| ()).unwrap().asset.tree;
        let points: Vec<_> = (0..tree.point_count()).map(|i| tree.point(i).as_dvec3()).collect();
        for i in 0..points.len() {
            for j in 0..i {
                // Points on the two sides of a thin wall may be closer.
                if tree.normal(i).dot(tree.normal(j)) > 0.0 {
                    prop_assert!(points[i].distance(points[j]) > 0.999 * spacing);
                }
            }
        }
        for (t, u, v) in at {
            let [a, b, c] = mesh.triangles()[t].map(|v| mesh.vertices()[v as usize]);
            let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
            let place = a + (b - a) * u + (c - a) * v;
            let distances = points.iter().map(|p| p.distance(place));
            let nearest = distances.fold(f64::INFINITY, f64::min);
            prop_assert!(nearest <= 2.23 * spacing, "{place} is {nearest} m from the next point");
        }
    }
}

#[test]
fn points_keep_their_distance_and_cover_the_surface() {
    let mesh = Mesh::cuboid([1.0, 0.6, 0.3]).unwrap();
    for points in [50, 700, 5000] {
        let asset = asset(&mesh, points, Encoding::Distances(None));
        let found = asset.tree.point_count() as f64;
        let off = (found - f64::from(points)).abs();
        assert!(
            off <= (0.02 * found).max(1.0),
            "{found} in place of {points}"
        );
        // On a surface this flat, the area of a point bounds the distance of the next.
        let spacing = (mesh.area() / found).sqrt();
        let closest = |p: DVec3, skip: usize| {
            (0..asset.tree.point_count())
                .filter(|&i| i != skip)
                .map(|i| asset.tree.point(i).as_dvec3().distance(p))
                .fold(f64::INFINITY, f64::min)
        };
        for i in (0..asset.tree.point_count()).step_by(7) {
            let p = asset.tree.point(i).as_dvec3();
            assert!(closest(p, i) > 0.6 * spacing);
            assert!(exact_penetration(&mesh, p).abs() < 1e-6);
            let inward = asset.tree.normal(i).as_dvec3();
            assert!(exact_penetration(&mesh, p + inward * 0.01) > 0.0);
        }
        // Corners are the hardest to reach.
        for &corner in mesh.vertices() {
            assert!(closest(corner, usize::MAX) < 1.7 * spacing);
        }
    }
}

#[test]
fn the_number_of_threads_changes_no_byte() {
    let mesh = Mesh::icosphere(0.5, 3).unwrap();
    let bytes = |threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| asset(&mesh, 500, Encoding::Distances(None)).to_bytes())
    };
    let one = bytes(1);
    assert!(one == bytes(2));
    assert!(one == bytes(5));
}

/// A wall thinner than the spacing has points on both sides.
#[test]
fn both_sides_of_a_thin_wall_are_sampled() {
    let mesh = Mesh::cuboid([1.0, 0.01, 1.0]).unwrap();
    let options = BuildOptions {
        resolution: Resolution::VoxelSize(0.005),
        points: PointCount::About(500),
        ..BuildOptions::default()
    };
    let tree = build(&mesh, &options, &|_| ()).unwrap().asset.tree;
    for side in [-1.0, 1.0] {
        let on_side = (0..tree.point_count()).filter(|&i| tree.point(i).y * side > 0.004);
        let facing = on_side.clone().filter(|&i| tree.normal(i).y * side < 0.0);
        assert!(on_side.count() > 180 && facing.count() > 180);
    }
}
