//! Rays, projections and casts of shapes, from far away, near and within, against parry's triangle
//! meshes; in single and in double precision.

// Numbers of rapier are 32-bit or 64-bit.
#![allow(clippy::unnecessary_cast, clippy::useless_conversion)]

use std::sync::LazyLock;

use glamx::{DQuat, DVec3};
use proptest::prelude::*;
use vps_build::{BuildOptions, ExactSolid, Mesh, PointCount, Resolution, Sign, models};
use vps_rapier::rapier3d::parry::query::details::ShapeCastOptions;
use vps_rapier::rapier3d::parry::query::{PointQuery, QueryDispatcher, Ray, RayCast};
use vps_rapier::rapier3d::parry::shape::{Ball, TriMesh};
use vps_rapier::rapier3d::prelude::*;
use vps_rapier::{VpsDispatcher, VpsShape, VpsShapeBuilder};

const VOXEL: f64 = 0.02;

struct Solid {
    name: &'static str,
    shape: VpsShape,
    mesh: TriMesh,
    exact: ExactSolid,
}

fn solid(name: &'static str, mesh: Mesh) -> Solid {
    let options = BuildOptions {
        resolution: Resolution::VoxelSize(VOXEL),
        points: PointCount::About(2000),
        ..BuildOptions::default()
    };
    let vertices = mesh.vertices().iter().map(|&v| from_exact(v)).collect();
    Solid {
        name,
        mesh: TriMesh::with_flags(vertices, mesh.triangles().to_vec(), TriMeshFlags::ORIENTED)
            .unwrap(),
        exact: ExactSolid::new(&mesh, Sign::default()).unwrap(),
        shape: VpsShapeBuilder::new(mesh).options(options).build().unwrap(),
    }
}

fn from_exact(v: DVec3) -> Vector {
    Vector::from_array(v.to_array().map(|c| c as Real))
}

fn to_exact(v: Vector) -> DVec3 {
    DVec3::from_array(v.to_array().map(f64::from))
}

fn turned(mesh: &Mesh, axis: DVec3, angle: f64) -> Mesh {
    let turn = DQuat::from_axis_angle(axis.normalize(), angle);
    let vertices: Vec<_> = mesh.vertices().iter().map(|&v| turn * v).collect();
    Mesh::new(&vertices, mesh.triangles()).unwrap()
}

static SOLIDS: LazyLock<Vec<Solid>> = LazyLock::new(|| {
    let askew = DVec3::new(1.0, 2.0, -0.5);
    vec![
        solid("frame", models::cube_frame(0.1)),
        solid("askew frame", turned(&models::cube_frame(0.08), askew, 0.8)),
        solid("window", models::window(0.08)),
        solid("askew window", turned(&models::window(0.03), askew, 2.1)),
        solid("torus", models::torus(32)),
        solid("knot", models::trefoil_knot(64)),
        solid("cup", models::cup(32)),
    ]
});

fn vector(size: f64) -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(-size..size).prop_map(DVec3::from_array)
}

/// Points in and around the solids, and far away.
fn place() -> impl Strategy<Value = DVec3> {
    // In single precision, larger coordinates would lose more than the tolerance.
    let farthest = if size_of::<Real>() == 8 { 1e6 } else { 500.0 };
    prop_oneof![
        3 => vector(0.55),
        2 => vector(2.0),
        1 => vector(farthest),
    ]
}

/// Distance of the exact hit in metres, and its normal.
fn exact_hit(solid: &Solid, origin: DVec3, direction: DVec3) -> Option<(f64, DVec3)> {
    let ray = Ray::new(from_exact(origin), from_exact(direction));
    let hit = solid.mesh.cast_local_ray_and_get_normal(&ray, 1e9, false)?;
    Some((f64::from(hit.time_of_impact), to_exact(hit.normal)))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(
        1000 * std::env::var("VPS_TEST_TIMES").map_or(1, |t| t.parse::<u32>().unwrap())
    ))]

    #[test]
    fn rays_hit_what_there_is(
        which in 0..7_usize, origin in place(), towards in vector(0.5), speed in -3.0..3.0_f64,
    ) {
        let solid = &SOLIDS[which];
        let direction = (towards - origin).normalize();
        let speed = 10_f64.powf(speed);
        let ray = Ray::new(from_exact(origin), from_exact(direction * speed));
        // The ray as it is in its precision.
        let (origin, direction) = (to_exact(ray.origin), to_exact(ray.dir).normalize());
        let rounding = 1e-6 * origin.length();
        let depth = |at: f64| {
            solid.exact.penetration(origin + direction * at, 0).penetration_m
        };
        let starts_inside = solid.shape.contains_local_point(ray.origin);
        if depth(0.0).abs() > VOXEL {
            prop_assert_eq!(starts_inside, depth(0.0) > 0.0);
        }
        let hit = solid.shape.cast_local_ray_and_get_normal(&ray, Real::MAX, false);
        let side = if starts_inside { -1.0 } else { 1.0 };
        // Before the hit it was nowhere deeper than a voxel on the other side.
        let end = hit.map_or(2.0 * origin.length() + 2.0, |h| f64::from(h.time_of_impact) * speed);
        let start = (origin.length() - 1.0).max(0.0).min(end);
        let mut at = start;
        while at < end - VOXEL && at < start + 3.0 {
            prop_assert!(side * depth(at) < VOXEL, "{}: passes {at} of {end}", solid.name);
            at += 0.5 * VOXEL;
        }
        if let Some(hit) = hit {
            prop_assert!(depth(end).abs() <= VOXEL + rounding, "{}: {}", solid.name, depth(end));
            prop_assert!((hit.normal.length() - 1.0).abs() < 1e-3);
            prop_assert!(to_exact(hit.normal).dot(direction) < 1e-3);
            // Within the time, or not at all.
            let time = hit.time_of_impact;
            let again = solid.shape.cast_local_ray_and_get_normal(&ray, time * 1.001, false);
            prop_assert!(again.is_some());
            prop_assert_eq!(solid.shape.cast_local_ray(&ray, time * 0.99 - 1e-6, false), None);
        }
        let solid_hit = solid.shape.cast_local_ray(&ray, Real::MAX, true);
        if starts_inside {
            prop_assert_eq!(solid_hit, Some(0.0));
        } else {
            prop_assert_eq!(solid_hit, hit.map(|h| h.time_of_impact));
        }
        // Where a ray and its neighbours hit one face and do not graze it, the hit is there.
        if starts_inside == (depth(0.0) > 0.0) && depth(0.0).abs() > VOXEL {
            let Some((distance, normal)) = exact_hit(solid, origin, direction) else {
                return Ok(());
            };
            let (aside, beside) = direction.any_orthonormal_pair();
            let all = [aside, -aside, beside, -beside].map(|off| {
                exact_hit(solid, origin + off * (0.5 * VOXEL), direction)
            });
            let is_face = all.iter().flatten().all(|(d, n)| {
                n.dot(normal) > 0.99 && (d - distance).abs() < 2.0 * VOXEL
            });
            let slope = -normal.dot(direction);
            if all.iter().all(Option::is_some) && is_face && slope > 0.5 {
                let hit = hit.expect("the same as parry's");
                let off = (end - distance).abs() * slope;
                prop_assert!(off <= VOXEL + rounding, "{}: {end}, exact {distance}", solid.name);
                let agree = to_exact(hit.normal).dot(normal);
                prop_assert!(agree > 0.7, "{}: {} {normal}", solid.name, hit.normal);
            }
        }
    }

    #[test]
    fn projections_are_the_closest_points(which in 0..7_usize, point in place()) {
        let solid = &SOLIDS[which];
        let point = from_exact(point);
        let exact = solid.exact.penetration(to_exact(point), 0).penetration_m;
        let found = solid.shape.project_local_point(point, false);
        let rounding = 2e-7 * exact.abs();
        let distance = to_exact(found.point).distance(to_exact(point));
        let off = distance - exact.abs();
        prop_assert!(off.abs() <= VOXEL + rounding, "{}: {distance}, exact {exact}", solid.name);
        let on_surface = solid.exact.penetration(to_exact(found.point), 0).penetration_m;
        prop_assert!(on_surface.abs() < VOXEL, "{}: {on_surface}", solid.name);
        prop_assert_eq!(found.is_inside, solid.shape.contains_local_point(point));
        if exact.abs() > VOXEL {
            prop_assert_eq!(found.is_inside, exact > 0.0);
        }
        let filled = solid.shape.project_local_point(point, true);
        prop_assert_eq!(filled.is_inside, found.is_inside);
        let expected = if found.is_inside { point } else { found.point };
        prop_assert_eq!(filled.point, expected);
        let signed = f64::from(solid.shape.distance_to_local_point(point, false));
        let expected = if found.is_inside { -distance } else { distance };
        prop_assert!((signed - expected).abs() <= 1e-6 * (1.0 + distance));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    /// Plates a voxel thick and bars of two, however they lie in the grid.
    #[test]
    fn no_ray_passes_through_what_is_thin(
        axis in vector(1.0), angle in 0.0..3.0_f64, is_bar in any::<bool>(), thicker in 1.0..1.5_f64,
        rays in prop::collection::vec((vector(1.0), -0.9..0.9_f64, -0.9..0.9_f64), 40),
    ) {
        prop_assume!(axis.length() > 0.1);
        let thickness = VOXEL * thicker;
        let extents = if is_bar {
            [0.6, 2.0 * thickness, 2.0 * thickness]
        } else {
            [0.6, thickness, 0.4]
        };
        let mesh = turned(&Mesh::cuboid(extents).unwrap(), axis, angle);
        let turn = DQuat::from_axis_angle(axis.normalize(), angle);
        let solid = solid("thin", mesh);
        for (from, u, v) in rays {
            // Through the middle of the thin part, from one side to the other.
            let middle = turn * if is_bar {
                DVec3::new(0.28 * u, 0.0, 0.0)
            } else {
                DVec3::new(0.28 * u, 0.0, 0.18 * v)
            };
            let from = turn * if from.y.abs() > 0.3 { from } else { from + DVec3::Y };
            let ray = Ray::new(from_exact(middle + from), from_exact(-from));
            let hit = solid.shape.cast_local_ray(&ray, 2.0, true);
            let hit = hit.map(|t| (f64::from(t) - 1.0).abs() * from.length());
            // An oblique ray stays longer in the thin part.
            prop_assert!(hit.is_some_and(|off| off < 10.0 * VOXEL), "{hit:?} at {middle}");
        }
    }
}

/// As for parry's own shapes, a ray from within leaves through the wall, with a normal against it.
#[test]
fn rays_from_within_are_as_those_of_parry() {
    let half = Vector::new(0.3, 0.2, 0.25);
    let mesh = Mesh::cuboid([0.6, 0.4, 0.5]).unwrap();
    let shape = solid("box", mesh).shape;
    let cuboid = SharedShape::cuboid(half.x, half.y, half.z);
    for direction in [
        Vector::X,
        -Vector::Y,
        Vector::Z * 0.01,
        Vector::new(0.5, 3.0, 0.2),
    ] {
        let ray = Ray::new(Vector::new(0.05, -0.02, 0.03), direction);
        let cast = |shape: &dyn Shape, solid| shape.cast_local_ray_and_get_normal(&ray, 1e6, solid);
        let (found, expected) = (cast(&shape, false).unwrap(), cast(&*cuboid, false).unwrap());
        let off = (found.time_of_impact - expected.time_of_impact) * direction.length();
        assert!(off.abs() < 1e-3, "{off}");
        assert!(
            found.normal.dot(expected.normal) > 0.99,
            "{} {}",
            found.normal,
            expected.normal
        );
        assert_eq!(cast(&shape, true).unwrap().time_of_impact, 0.0);
    }
    // A ray from nowhere, one without a direction, and one that points away.
    let nowhere = Ray::new(Vector::splat(Real::NAN), Vector::X);
    assert_eq!(shape.cast_local_ray(&nowhere, 1.0, true), None);
    let still = Ray::new(Vector::X, Vector::ZERO);
    assert_eq!(shape.cast_local_ray(&still, 1.0, true), None);
    let away = Ray::new(Vector::X, Vector::X);
    assert_eq!(shape.cast_local_ray(&away, Real::MAX, true), None);
}

/// A fast small ball meets the bars of a distant cage at the right time, or flies between them.
#[test]
fn a_fast_ball_meets_the_bars_of_a_cage() {
    let solid = &SOLIDS[0];
    let dispatcher = VpsDispatcher::default();
    let ball = Ball::new(0.02);
    let (mut met, mut passed) = (0, 0);
    for i in 0..60 {
        // From all around, at bars and past them.
        let turn = DQuat::from_rotation_y(0.1 * f64::from(i)) * DQuat::from_rotation_x(0.37);
        let aim = DVec3::new(0.02 * f64::from(i % 9), 0.45 - 0.03 * f64::from(i % 7), 0.0);
        let from = turn * (aim + DVec3::new(0.0, 0.0, 40.0));
        let velocity = turn * DVec3::new(0.0, 0.0, -500.0);
        let options = ShapeCastOptions {
            max_time_of_impact: 1.0,
            ..ShapeCastOptions::default()
        };
        let (pose, velocity) = (
            Pose::from_translation(from_exact(from)),
            from_exact(velocity),
        );
        let hit = dispatcher
            .cast_shapes(&pose, velocity, &solid.shape, &ball, options)
            .unwrap();
        let found = hit.map(|h| f64::from(h.time_of_impact) * 500.0);
        // The smallest distance of the ball's centre from the bars, and where it first comes close.
        let depth = |distance: f64| {
            let at = from + to_exact(velocity).normalize() * distance;
            solid.exact.penetration(at, 0).penetration_m + 0.02
        };
        let distances = || (0..3000).map(|i| 39.0 + 0.001 * f64::from(i));
        let deepest = distances().map(depth).fold(f64::NEG_INFINITY, f64::max);
        match found {
            Some(distance) => {
                assert!(
                    depth(distance).abs() < VOXEL,
                    "{i}: {} at {distance}",
                    depth(distance)
                );
                assert!(
                    distances()
                        .filter(|&d| d < distance)
                        .all(|d| depth(d) < VOXEL)
                );
                met += 1;
            }
            None => {
                assert!(deepest < VOXEL, "{i}: {deepest}");
                passed += 1;
            }
        }
    }
    assert!(met > 10 && passed > 10, "{met} {passed}");
}
