//! Bodies in worlds, and queries about shapes whose answers are known.

mod support;

use rapier3d::parry::query::details::ShapeCastOptions;
use rapier3d::parry::query::{DefaultQueryDispatcher, NonlinearRigidMotion, QueryDispatcher};
use rapier3d::parry::utils::Array2;
use rapier3d::prelude::*;
use support::asset;
use vps_build::Mesh;
use vps_core::DistanceField;
use vps_core::conformance::check;
use vps_rapier::{Role, Sampling, ShapeField, VpsDispatcher, VpsShape, narrow_phase};

/// A thick L. It is not convex, and its hull would stand differently.
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
    let corners = [[-1.0, -1.0], [-1.0, 1.0], [1.0, 1.0], [1.0, -1.0]];
    let corners = corners.map(|[x, z]| Vector::new(x, 0.05, z));
    let (vertices, triangles) = Cuboid::new(Vector::new(1.0, 0.05, 1.0)).to_trimesh();
    let oriented = TriMeshFlags::ORIENTED;
    let grounds = [
        ColliderBuilder::cuboid(1.0, 0.05, 1.0),
        ColliderBuilder::new(SharedShape::halfspace(up)).translation(up * 0.05),
        ColliderBuilder::round_cuboid(1.0, 0.03, 1.0, 0.02),
        ColliderBuilder::cylinder(0.05, 1.0),
        // Two boxes that overlap below the body, open surfaces, and a closed mesh.
        ColliderBuilder::new(SharedShape::compound(vec![
            (
                Pose::translation(-0.4, 0.0, 0.0),
                SharedShape::cuboid(0.6, 0.05, 1.0),
            ),
            (
                Pose::translation(0.6, 0.0, 0.0),
                SharedShape::cuboid(0.6, 0.05, 1.0),
            ),
        ])),
        ColliderBuilder::trimesh(corners.to_vec(), vec![[0, 1, 2], [0, 2, 3]]).unwrap(),
        ColliderBuilder::heightfield(Array2::repeat(5, 5, 1.0), Vector::new(2.0, 0.05, 2.0)),
        ColliderBuilder::new(
            SharedShape::trimesh_with_flags(vertices, triangles, oriented).unwrap(),
        ),
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
        // Every step searches for contacts, so that none is held by old ones.
        world.integration_parameters.contact_recycling = false;
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
            body.linvel().length() < 0.001,
            "ground {i}: {}",
            body.linvel()
        );
        assert!(
            body.angvel().length() < 0.01,
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
        let dispatcher = VpsDispatcher {
            sampling,
            ..VpsDispatcher::default()
        }
        .chain(DefaultQueryDispatcher);
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
                // Deeper, the penetration of points differs from the translation that separates.
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
                // The edges of a sampled box are round, so a grazing ray meets them late.
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

/// Pseudorandom numbers in 0..1.
fn scattered() -> impl FnMut() -> f32 {
    let mut n = 0_u32;
    move || {
        n = n.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        (n >> 8) as f32 / (1 << 24) as f32
    }
}

#[test]
fn fields_of_parry_shapes_conform() {
    let boxes = SharedShape::compound(vec![
        (Pose::IDENTITY, SharedShape::cuboid(0.5, 0.5, 0.5)),
        (
            Pose::translation(0.9, 0.0, 0.1),
            SharedShape::cuboid(0.55, 0.5, 0.5),
        ),
    ]);
    let (vertices, triangles) = Cuboid::new(Vector::new(0.5, 0.3, 0.4)).to_trimesh();
    let oriented = TriMeshFlags::ORIENTED;
    let closed = SharedShape::trimesh_with_flags(vertices.clone(), triangles, oriented).unwrap();
    let sheet = SharedShape::trimesh(vertices, vec![[0, 1, 2]]).unwrap();
    let hills = Array2::new(3, 3, vec![0.0, 0.4, 0.1, 0.3, 0.0, 0.2, 0.1, 0.5, 0.0]);
    let hills = SharedShape::heightfield(hills, Vector::new(2.0, 1.0, 2.0));
    let shapes = [
        boxes,
        closed,
        sheet,
        hills,
        SharedShape::capsule_y(0.3, 0.2),
        SharedShape::cone(0.4, 0.3),
    ];
    let mut next = scattered();
    for (i, shape) in shapes.iter().enumerate() {
        let field = ShapeField::new(&**shape, 0.07);
        let mut inside_found = 0;
        for _ in 0..4000 {
            let mut vector =
                |size: f32| Vector::new(next() - 0.5, next() - 0.5, next() - 0.5) * 2.0 * size;
            let (center, towards) = (vector(1.2), vector(1.0));
            let inside = towards.normalize_or_zero() * towards.length().min(1.0);
            let radius = 0.4 * next();
            inside_found += u32::from(field.signed_distance(center + inside * radius) < 0.0);
            if let Err(violation) = check(&field, center, radius, inside, Vector::Y) {
                panic!("shape {i}: {violation}");
            }
        }
        assert!(inside_found > 0, "shape {i}");
    }
    // Deep in one box of the compound, and outside of the other.
    let field = ShapeField::new(&*shapes[0], 0.07);
    assert!((field.penetration(Vector::new(0.3, 0.0, 0.0), Vector::Y) - 0.2).abs() < 1e-6);
}

#[test]
fn a_cast_between_vps_shapes_does_not_jump_through() {
    let small = VpsShape::new(asset(&Mesh::cuboid([0.1, 0.1, 0.1]).unwrap(), 600));
    let wall = asset(&Mesh::cuboid([0.5, 0.5, 0.02]).unwrap(), 4000);
    let wall = VpsShape::new(wall).with_role(Role::Voxelmap);
    let dispatcher = VpsDispatcher::default();
    for (x, z) in [(0.0, 3.0), (0.2, 9.0), (-0.15, 1.4), (0.21, -6.0)] {
        let start = Pose::translation(x, 0.03, z);
        let velocity = Vector::new(0.0, 0.0, -z);
        let hit = dispatcher
            .cast_shapes(&start, velocity, &wall, &small, ShapeCastOptions::default())
            .unwrap()
            .unwrap();
        let expected = 1.0 - 0.06 / z.abs();
        assert!(
            (hit.time_of_impact - expected).abs() * z.abs() < 0.003,
            "{hit:?} {expected}"
        );
        let motion = |pose: Pose, linvel| {
            NonlinearRigidMotion::new(pose, Vector::ZERO, linvel, Vector::ZERO)
        };
        let (still, moving) = (
            motion(Pose::IDENTITY, Vector::ZERO),
            motion(start, velocity),
        );
        let hit = dispatcher
            .cast_shapes_nonlinear(&still, &wall, &moving, &small, 0.0, 2.0, true)
            .unwrap()
            .unwrap();
        assert!(
            (hit.time_of_impact - expected).abs() * z.abs() < 0.003,
            "{hit:?} {expected}"
        );
    }
}
