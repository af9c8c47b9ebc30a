//! Bodies in worlds, and queries about shapes whose answers are known.

use std::sync::Arc;

use rapier3d::parry::query::details::ShapeCastOptions;
use rapier3d::parry::query::{DefaultQueryDispatcher, QueryDispatcher};
use rapier3d::prelude::*;
use vps_build::{BuildOptions, Mesh, Resolution, build};
use vps_core::Asset;
use vps_rapier::{Role, Sampling, VpsDispatcher, VpsShape, narrow_phase};

fn asset(mesh: &Mesh, points: u32) -> Arc<Asset<'static>> {
    let options = BuildOptions {
        resolution: Resolution::VoxelsAlongLongest(40),
        points,
        ..BuildOptions::default()
    };
    Arc::new(build(mesh, &options, &|_| ()).unwrap())
}

/// A thick L: not convex, and its hull would stand differently.
fn angle_bracket() -> Mesh {
    let outline = [
        (0.0, 0.0),
        (0.3, 0.0),
        (0.3, 0.1),
        (0.1, 0.1),
        (0.1, 0.4),
        (0.0, 0.4),
    ];
    let mut vertices = Vec::new();
    for z in [0.0, 0.1] {
        vertices.extend(outline.map(|(x, y)| glamx::DVec3::new(x, y, z)));
    }
    let mut triangles = Vec::new();
    for [a, b, c] in [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]] {
        triangles.push([a, c, b]);
        triangles.push([a + 6, b + 6, c + 6]);
    }
    for a in 0..6 {
        let b = (a + 1) % 6;
        triangles.push([a, b, b + 6]);
        triangles.push([a, b + 6, a + 6]);
    }
    Mesh::new(&vertices, &triangles).unwrap()
}

fn world() -> PhysicsWorld {
    PhysicsWorld {
        narrow_phase: narrow_phase(),
        ..PhysicsWorld::default()
    }
}

fn shape(shape: VpsShape) -> ColliderBuilder {
    ColliderBuilder::new(shape.into())
}

#[test]
fn a_bracket_falls_and_comes_to_rest_on_every_kind_of_ground() {
    let bracket = VpsShape::new(asset(&angle_bracket(), 1500));
    let plate = VpsShape::new(asset(&Mesh::cuboid([2.0, 0.1, 2.0]).unwrap(), 200));
    let up = Vector::Y;
    let grounds = [
        ColliderBuilder::cuboid(1.0, 0.05, 1.0),
        ColliderBuilder::new(SharedShape::halfspace(up)).translation(up * 0.05),
        ColliderBuilder::round_cuboid(1.0, 0.03, 1.0, 0.02),
        ColliderBuilder::cylinder(0.05, 1.0),
        shape(plate.with_role(Role::Voxelmap)),
    ];
    for (i, ground) in grounds.into_iter().enumerate() {
        let mut world = world();
        world.insert(RigidBodyBuilder::fixed(), ground);
        let start = RigidBodyBuilder::dynamic()
            .translation(Vector::new(0.1, 0.3, -0.1))
            .rotation(Vector::new(1.3, 0.2, 0.1))
            .can_sleep(false);
        let (body, _) = world.insert(start, shape(bracket.clone()));
        for _ in 0..360 {
            world.step();
        }
        let body = &world.bodies[body];
        // Lying on one of its two large faces, its centre is half a thickness above the ground.
        let center = body.center_of_mass().y;
        assert!(
            (center - 0.1).abs() < 0.004,
            "ground {i}: centre at {center}"
        );
        assert!(
            body.linvel().length() < 0.01,
            "ground {i}: {}",
            body.linvel()
        );
        assert!(
            body.angvel().length() < 0.1,
            "ground {i}: {}",
            body.angvel()
        );
    }
}

#[test]
fn bodies_of_vps_shapes_hold_each_other() {
    let bracket = asset(&angle_bracket(), 1500);
    let mut world = world();
    world.insert(
        RigidBodyBuilder::fixed(),
        ColliderBuilder::cuboid(1.0, 0.05, 1.0),
    );
    let flat = Vector::new(std::f32::consts::FRAC_PI_2, 0.0, 0.0);
    let handles: Vec<_> = (0..3)
        .map(|i| {
            let start = RigidBodyBuilder::dynamic()
                .translation(Vector::new(0.0, 0.16 + 0.11 * i as f32, 0.0))
                .rotation(flat);
            world.insert(start, shape(VpsShape::new(bracket.clone()))).0
        })
        .collect();
    for _ in 0..240 {
        world.step();
    }
    for (i, handle) in handles.into_iter().enumerate() {
        let center = world.bodies[handle].center_of_mass().y;
        let expected = 0.1 + 0.1 * i as f32;
        assert!((center - expected).abs() < 0.01, "body {i} at {center}");
    }
}

#[test]
fn mass_properties_are_those_of_the_solid() {
    let cuboid = VpsShape::new(asset(&Mesh::cuboid([0.4, 0.2, 0.3]).unwrap(), 100));
    let ours = Shape::mass_properties(&cuboid, 500.0);
    let exact = Cuboid::new(Vector::new(0.2, 0.1, 0.15)).mass_properties(500.0);
    assert!((ours.mass() - exact.mass()).abs() < 1e-3);
    let [ours, exact] = [ours, exact].map(|m| m.reconstruct_inertia_matrix());
    for (a, b) in ours.to_cols_array().into_iter().zip(exact.to_cols_array()) {
        assert!((a - b).abs() < 1e-4, "{a} {b}");
    }
}

#[test]
fn queries_agree_with_parry_in_both_orders() {
    let half = Vector::new(0.3, 0.2, 0.25);
    let box_mesh = Mesh::cuboid((half * 2.0).as_dvec3().to_array()).unwrap();
    let ours = VpsShape::new(asset(&box_mesh, 3000));
    let exact = Cuboid::new(half);
    let voxel = ours.asset().voxelmap.grid().voxel_size();
    let others: [&dyn Shape; 4] = [
        &Ball::new(0.2),
        &Capsule::new_y(0.2, 0.1),
        &Cuboid::new(Vector::new(0.5, 0.1, 0.5)),
        &Cylinder::new(0.2, 0.15),
    ];
    for sampling in [Sampling::Trilinear, Sampling::Local] {
        let dispatcher = VpsDispatcher { sampling }.chain(DefaultQueryDispatcher);
        for (i, other) in others.into_iter().enumerate() {
            for step in 0..12 {
                // From well apart to deep inside, along the face normal x.
                let pos = Pose::translation(0.8 - 0.06 * step as f32, 0.01, 0.02);
                let distance = |a: &dyn Shape, b: &dyn Shape, pos12: &Pose| {
                    let distance = dispatcher.distance(pos12, a, b).unwrap().distance;
                    let touch = dispatcher
                        .intersection_test(pos12, a, b)
                        .unwrap()
                        .intersecting;
                    let contact = dispatcher.contact(pos12, a, b, 1.0).unwrap().unwrap();
                    assert_eq!(touch, contact.dist <= 0.0);
                    assert!((contact.dist.max(0.0) - distance).abs() < 1e-6);
                    // The two points are apart along the normal by the distance.
                    let between = *pos12 * contact.point2 - contact.point1;
                    let along = between.dot(contact.normal1);
                    assert!(
                        (along - contact.dist).abs() < 1e-3 + 0.1 * voxel,
                        "{along} {contact:?}"
                    );
                    contact.dist
                };
                let forward = distance(&ours, other, &pos);
                let backward = distance(other, &ours, &pos.inverse());
                assert!((forward - backward).abs() < 1e-5);
                let expected =
                    rapier3d::parry::query::contact(&Pose::IDENTITY, &exact, &pos, other, 2.0)
                        .unwrap()
                        .unwrap()
                        .dist;
                // Deeper, the depth of points and the way out of an overlap are two things.
                if expected > -0.08 {
                    let off = (forward - expected).abs();
                    assert!(
                        off < 0.02,
                        "shape {i} step {step}: {forward}, exact {expected}"
                    );
                }
            }
        }
    }
}

#[test]
fn rays_points_and_casts_meet_the_surface() {
    let half = Vector::new(0.3, 0.2, 0.25);
    let box_mesh = Mesh::cuboid((half * 2.0).as_dvec3().to_array()).unwrap();
    let ours = VpsShape::new(asset(&box_mesh, 3000));
    let exact = Cuboid::new(half);
    let tolerance = 0.1 * ours.asset().voxelmap.grid().voxel_size();
    for i in 0..200 {
        let angle = i as f32 * 0.7;
        let direction = Vector::new(angle.cos(), (i as f32 * 0.37).sin(), angle.sin());
        let origin = direction * 2.0 + Vector::new(0.1, -0.05, 0.02);
        let ray = Ray::new(origin, -direction.normalize());
        let hit = ours.cast_local_ray_and_get_normal(&ray, 10.0, true);
        let expected = exact.cast_local_ray_and_get_normal(&ray, 10.0, true);
        match (hit, expected) {
            (Some(hit), Some(expected)) => {
                let off = (hit.time_of_impact - expected.time_of_impact).abs();
                // Edges of a sampled box are round, a grazing ray meets them late.
                let grazing = hit.normal.dot(-ray.dir) < 0.5 || hit.normal.max_element() < 0.99;
                assert!(off < tolerance || grazing, "{hit:?} {expected:?}");
            }
            (hit, expected) => assert!(hit.is_none() == expected.is_none()),
        }
        let from_inside = Ray::new(Vector::new(0.01, 0.02, 0.03), direction);
        let hit = ours.cast_local_ray(&from_inside, 10.0, false).unwrap();
        let expected = exact.cast_local_ray(&from_inside, 10.0, false).unwrap();
        let size = direction.length();
        assert!(
            (hit - expected).abs() * size < 3.0 * tolerance + 0.01,
            "{hit} {expected}"
        );
        assert_eq!(ours.cast_local_ray(&from_inside, 10.0, true), Some(0.0));
        let away = Ray::new(origin, direction);
        assert!(ours.cast_local_ray(&away, f32::MAX, true).is_none());
        let point = direction * 0.4;
        assert_eq!(
            ours.contains_local_point(point),
            exact.contains_local_point(point)
        );
    }
    let dispatcher = VpsDispatcher::default();
    let hit = dispatcher
        .cast_shapes(
            &Pose::translation(2.0, 0.0, 0.0),
            Vector::new(-4.0, 0.0, 0.0),
            &ours,
            &Ball::new(0.2),
            ShapeCastOptions::default(),
        )
        .unwrap()
        .unwrap();
    assert!((hit.time_of_impact - 1.5 / 4.0).abs() < 1e-3, "{hit:?}");
}
