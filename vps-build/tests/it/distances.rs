//! Distances everywhere, in the grid and far outside, against those of the exact solids.

use proptest::prelude::*;
use vps_build::{
    BuildOptions, ClosestPoints, ExactSolid, Mesh, PointCount, Resolution, Sign, build, models,
};
use vps_core::{DistanceField, Vec3};

use crate::support::{cases, density, direction, encoding, vector};

/// Bars, plates, and strands that wind around each other.
fn mesh() -> impl Strategy<Value = Mesh> {
    prop_oneof![
        (0.05..0.3_f64).prop_map(models::cube_frame),
        (0.05..0.3_f64).prop_map(models::window),
        Just(models::torus(24)),
        Just(models::trefoil_knot(48)),
        Just(models::cup(24)),
        (0.1..1.0_f64).prop_map(|height| Mesh::cuboid([1.0, height, 0.7]).unwrap()),
    ]
}

proptest! {
    #![proptest_config(cases(48))]

    #[test]
    fn the_solid_never_seems_further_than_it_is(
        mesh in mesh(), encoding in encoding(), density in density(),
        by_descent in prop::bool::weighted(0.2), margin in 1..6_u32,
        points in prop::collection::vec((vector(1.0), direction(), 0..3_usize), 300),
    ) {
        let options = BuildOptions {
            resolution: Resolution::VoxelsAlongLongest(24),
            margin,
            points: PointCount::About(10),
            encoding,
            density,
            closest_points: if by_descent { ClosestPoints::GradientDescent } else { ClosestPoints::Exact },
            ..BuildOptions::default()
        };
        let asset = build(&mesh, &options, &|_| ()).unwrap().asset;
        let exact = ExactSolid::new(&mesh, Sign::default()).unwrap();
        let map = &asset.voxelmap;
        let (local, linear, trilinear) = (map.local(), map.linear(), map.trilinear());
        for (point, normal, range) in points {
            // Around the surface, around the grid, and far outside.
            let point = point * [0.55, 1.2, 30.0][range];
            let distance = -exact.penetration(point.as_dvec3(), 0).penetration_m as f32;
            let rounding = 1e-5 * (1.0 + point.length());
            let sampled = trilinear.signed_distance(point);
            let over = trilinear.overestimate_bound_at(point) + rounding;
            prop_assert!(sampled <= distance + over, "{point}: {sampled}, {distance} + {over}");
            let off = trilinear.error_bound_at(point) + rounding;
            prop_assert!((sampled - distance).abs() <= off, "{point}: {sampled}, {distance} +- {off}");
            // The other samplings read up to four values, with their errors.
            let beyond = 4.0 * (map.error_bounds().beyond - map.error_bounds().in_band);
            for field in [&local as &dyn DistanceField, &linear] {
                let sampled = -field.penetration(point, normal);
                let over = field.error_bound() + beyond + rounding;
                prop_assert!(sampled <= distance + over, "{point}: {sampled}, {distance} + {over}");
            }
        }
    }
}

/// Where the surface is a face of the bounding box, distances from outside are exact.
#[test]
fn distances_of_faces_are_exact_from_afar() {
    let mesh = Mesh::cuboid([1.0, 0.4, 0.7]).unwrap();
    let options = BuildOptions {
        resolution: Resolution::VoxelsAlongLongest(25),
        points: PointCount::About(10),
        ..BuildOptions::default()
    };
    let map = build(&mesh, &options, &|_| ()).unwrap().asset.voxelmap;
    let near = map.error_bounds().in_band;
    for distance in [0.0, 0.1, 0.3, 1.0, 7.0, 100.0] {
        let point = Vec3::new(0.1, 0.2 + distance, -0.05);
        let off = map.trilinear().signed_distance(point) - distance;
        assert!(off.abs() <= near + 1e-6 * distance, "{distance}: {off}");
        assert!(map.trilinear().inward_direction(point).distance(-Vec3::Y) < 0.02);
        // Over an edge it is no longer than the path around the border.
        let over_edge = Vec3::new(0.5 + distance, 0.2 + distance, 0.0);
        let off = map.trilinear().signed_distance(over_edge) - 2.0_f32.sqrt() * distance;
        assert!(off <= map.trilinear().overestimate_bound_at(over_edge));
        assert!(off >= -map.trilinear().error_bound_at(over_edge));
    }
}
