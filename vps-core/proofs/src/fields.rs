//! Fields against what any field promises, and against the solids they stand for.

use crate::support::{asset, asset_of, bumpy_mesh, cases, density, direction, encoding, vector};
use glamx::BVec3;
use proptest::prelude::*;
use vps_build::{Encoding, Mesh};
use vps_core::conformance::check;
use vps_core::{Ball, Capsule, Cuboid, Cylinder, DistanceField, HalfSpace, Quat, Vec3, Voxelmap};

proptest! {
    #![proptest_config(cases(48))]

    #[test]
    fn voxelmaps_conform(
        mesh in bumpy_mesh(), encoding in encoding(),
        balls in prop::collection::vec(
            (vector(1.2), 0.0..0.5_f32, direction(), 0.0..1.0_f32, direction(), 0..3), 100),
    ) {
        let asset = asset(&mesh, 10, encoding);
        let map = &asset.voxelmap;
        for (center, radius, towards, how_far, normal, from_afar) in balls {
            // Some from outside of the grid, with balls that reach it or not.
            let center = if from_afar == 0 { center * 4.0 } else { center };
            let inside = towards * how_far;
            check(&map.local(), center, radius, inside, normal).unwrap();
            check(&map.linear(), center, radius, inside, normal).unwrap();
            check(&map.trilinear(), center, radius, inside, normal).unwrap();
        }
    }

    /// Close to the surface, where the curvature bounds a disc: points of the disc's rim, the
    /// highest where the field rises.
    #[test]
    fn small_discs_are_bounded(
        mesh in bumpy_mesh(), encoding in encoding(), density in density(),
        discs in prop::collection::vec(
            (0..1280_usize, 0.0..1.0_f32, -2.0..2.0_f32, 0.0..7.0_f32, direction(), 0.0..6.3_f32),
            100),
    ) {
        let asset = asset_of(&mesh, 10, encoding, density);
        let map = &asset.voxelmap;
        let (field, s) = (map.trilinear(), map.grid().voxel_size());
        for (t, u, off, radius, normal, turn) in discs {
            let [a, b, c] = mesh.triangles()[t].map(|v| mesh.vertices()[v as usize].as_vec3());
            let place = a.lerp(b, u).lerp(c, 0.5);
            let outward = (b - a).cross(c - a).normalize_or(Vec3::Y);
            let center = place + outward * (off * s);
            let radius = radius * s;
            let rising = field.inward_direction(center);
            let along = (rising - normal * rising.dot(normal)).normalize_or(normal.any_orthonormal_vector());
            check(&field, center, radius, along, normal).unwrap();
            let aside = Quat::from_axis_angle(normal, turn) * along;
            check(&field, center, radius, aside, normal).unwrap();
            check(&field, center, radius, rising, normal).unwrap();
        }
    }

    /// Discs that leave the grid or straddle its border, along any axes: of a bumpy body, and of a
    /// plate, whose field continues flat.
    #[test]
    fn discs_across_the_border_are_bounded(
        mesh in prop_oneof![bumpy_mesh(), Just(Mesh::cuboid([1.0, 0.2, 0.7]).unwrap())],
        encoding in encoding(), density in density(),
        discs in prop::collection::vec(
            (vector(1.0), vector(1.0), 0..8_u8, 0.0..7.0_f32, direction(), any::<bool>(), 0.0..6.3_f32),
            200),
    ) {
        let asset = asset_of(&mesh, 10, encoding, density);
        let map = &asset.voxelmap;
        let (field, s) = (map.trilinear(), map.grid().voxel_size());
        let bounds = map.grid().bounds();
        let middle = (bounds.min + bounds.max) * 0.5;
        for (at, off, on_border, radius, normal, is_level, turn) in discs {
            let on_border = BVec3::new(on_border & 1 > 0, on_border & 2 > 0, on_border & 4 > 0);
            let way = Vec3::select(on_border, at.signum(), at) * (bounds.max - middle);
            let center = middle + way + off * (8.0 * s);
            let rising = field.inward_direction(center);
            // Facing the body, or tilted in any direction.
            let normal = if is_level { rising.normalize_or(Vec3::Y) } else { normal };
            let along = (rising - normal * rising.dot(normal)).normalize_or(normal.any_orthonormal_vector());
            let aside = Quat::from_axis_angle(normal, turn) * along;
            let radius = radius * s;
            for inside in [along, rising, aside, aside * 0.5, (aside + rising).normalize_or(Vec3::Y)] {
                check(&field, center, radius, inside, normal).unwrap();
            }
        }
    }

    /// Penetrations of sampled solids against those of the exact solids.
    #[test]
    fn penetration_is_within_its_error_of_a_ball_and_a_box(
        points in prop::collection::vec((vector(0.62), direction()), 200),
    ) {
        for encoding in [Encoding::Distances(None), Encoding::Layers] {
            let half = Vec3::new(0.5, 0.3, 0.4);
            let mesh = Mesh::cuboid((half * 2.0).as_dvec3().to_array()).unwrap();
            check_against(&asset(&mesh, 10, encoding).voxelmap, &Cuboid::new(half), 0.0, &points)?;
            // Largest depth of the mesh's facets within the ball.
            let mesh = Mesh::icosphere(0.5, 4).unwrap();
            let facets = mesh.triangles().iter().map(|t| {
                let [a, b, c] = t.map(|v| mesh.vertices()[v as usize]);
                0.5 - ((a + b + c) / 3.0).length()
            });
            let facets = facets.fold(0.0, f64::max) as f32;
            check_against(&asset(&mesh, 10, encoding).voxelmap, &Ball::new(0.5), facets, &points)?;
        }
    }
}

fn check_against(
    map: &Voxelmap<'_>,
    exact: &impl DistanceField,
    mesh_error: f32,
    points: &[(Vec3, Vec3)],
) -> Result<(), TestCaseError> {
    let (local, trilinear) = (map.local(), map.trilinear());
    for &(p, normal) in points {
        let exact = exact.penetration(p, normal);
        // The error bound holds near the surface.
        let near = exact.abs() + 2.0 * map.grid().voxel_size() <= map.error_bounds().narrow_band;
        let beyond = if near { 0.0 } else { map.error_bounds().beyond };
        for (sampled, bound) in [
            (local.penetration(p, normal), local.error_bound()),
            (trilinear.penetration(p, normal), trilinear.error_bound()),
        ] {
            let off = (sampled - exact).abs();
            prop_assert!(
                off <= bound + beyond + mesh_error,
                "{p}: {sampled}, exact {exact}"
            );
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]
    #[test]
    fn analytic_fields_conform(
        center in vector(1.0), radius in 0.0..0.8_f32,
        towards in direction(), how_far in 0.0..1.0_f32, size in 0.1..0.7_f32,
    ) {
        let inside = towards * how_far;
        check(&Ball::new(size), center, radius, inside, towards).unwrap();
        check(&Cuboid::new(Vec3::new(size, 0.2, 0.5)), center, radius, inside, towards).unwrap();
        check(&HalfSpace::new(towards), center, radius, inside, towards).unwrap();
        check(&Capsule::new(size, 0.3), center, radius, inside, towards).unwrap();
        check(&Cylinder::new(size, 0.3), center, radius, inside, towards).unwrap();
    }
}

/// Over a flat face both samplings give the exact depth. So does eq. 4 for a shell that faces it.
#[test]
fn flat_faces_are_sampled_exactly() {
    let mesh = Mesh::cuboid([1.0, 0.6, 0.8]).unwrap();
    let asset = asset(&mesh, 10, Encoding::Distances(None));
    let (local, trilinear) = (asset.voxelmap.local(), asset.voxelmap.trilinear());
    let near = asset.voxelmap.error_bounds().in_band;
    for i in 0..200 {
        let depth = 0.001 * (i - 100) as f32;
        let p = Vec3::new(0.0013 * i as f32 - 0.1, 0.3 - depth, 0.05);
        // The body above is pushed up.
        assert!((local.penetration(p, Vec3::Y) - depth).abs() < 2.0 * near);
        assert!((trilinear.penetration(p, Vec3::Y) - depth).abs() < 2.0 * near);
        assert!(local.inward_direction(p).distance(-Vec3::Y) < 0.02);
    }
}
