//! One body within another, in single and in double precision.

// Numbers of rapier are 32-bit or 64-bit.
#![allow(clippy::unnecessary_cast, clippy::useless_conversion)]

use vps_build::{BuildOptions, Mesh, PointCount, Resolution, models};
use vps_rapier::rapier3d::parry::query::{
    ClosestPoints, ContactManifold, PersistentQueryDispatcher, QueryDispatcher,
};
use vps_rapier::rapier3d::prelude::*;
use vps_rapier::{Role, VpsDispatcher, VpsShape, VpsShapeBuilder, narrow_phase};

fn vps(mesh: &Mesh, points: u32) -> VpsShape {
    let options = BuildOptions {
        resolution: Resolution::VoxelsAlongLongest(40),
        points: PointCount::About(points),
        ..BuildOptions::default()
    };
    VpsShapeBuilder::new(mesh.clone())
        .options(options)
        .build()
        .unwrap()
}

fn triangles(mesh: &Mesh) -> (Vec<Vector>, Vec<[u32; 3]>) {
    let vector = |v: &glamx::DVec3| Vector::from_array(v.to_array().map(|c| c as Real));
    (
        mesh.vertices().iter().map(vector).collect(),
        mesh.triangles().to_vec(),
    )
}

/// A closed mesh with another one as its cavity.
fn hollow(outer: &Mesh, cavity: &Mesh) -> Mesh {
    let mut vertices = outer.vertices().to_vec();
    let first = vertices.len() as u32;
    vertices.extend(cavity.vertices());
    let mut triangles = outer.triangles().to_vec();
    let turned = cavity.triangles().iter().map(|&[a, b, c]| [a, c, b]);
    triangles.extend(turned.map(|t| t.map(|v| v + first)));
    Mesh::new(&vertices, &triangles).unwrap()
}

fn cube(extent: f64) -> Mesh {
    Mesh::cuboid([extent; 3]).unwrap()
}

/// Checks that all queries about a pair give about this depth, or this distance if it is negative.
fn check(name: &str, a: &dyn Shape, b: &dyn Shape, pos12: &Pose, depth: f64) {
    let dispatcher = VpsDispatcher::default();
    for (pose, a, b, order) in [(*pos12, a, b, "first"), (pos12.inverse(), b, a, "second")] {
        let overlaps = depth > 0.0;
        let touches = dispatcher.intersection_test(&pose, a, b).unwrap();
        assert_eq!(touches.intersecting, overlaps, "{name}, {order}");
        let distance = f64::from(dispatcher.distance(&pose, a, b).unwrap().distance);
        let expected = (-depth).max(0.0);
        assert!(
            (distance - expected).abs() < 0.03,
            "{name}, {order}: {distance} m apart"
        );
        let contact = dispatcher.contact(&pose, a, b, 0.001).unwrap();
        assert_eq!(contact.is_some(), overlaps, "{name}, {order}");
        let points = dispatcher.closest_points(&pose, a, b, 10.0).unwrap();
        assert_eq!(
            matches!(points, ClosestPoints::Intersecting),
            overlaps,
            "{name}, {order}"
        );
        let mut manifolds: Vec<ContactManifold<(), ()>> = Vec::new();
        dispatcher
            .contact_manifolds(&pose, a, b, 0.001, &mut manifolds, &mut None)
            .unwrap();
        let deepest = manifolds
            .iter()
            .flat_map(|m| m.points.iter())
            .map(|p| -p.dist);
        let deepest = f64::from(deepest.fold(Real::MIN, Real::max));
        assert_eq!(deepest > 0.0, overlaps, "{name}, {order}: {deepest}");
        if let Some(contact) = contact {
            let deep = f64::from(-contact.dist);
            assert!(
                (deep - depth).abs() < 0.05,
                "{name}, {order}: {deep} m deep, right {depth}"
            );
            assert!(
                (deepest - depth).abs() < 0.05,
                "{name}, {order}: {deepest} m in a manifold"
            );
        }
    }
}

#[test]
fn a_body_within_another_is_found_whichever_has_more_points() {
    let large = cube(1.0);
    let small = Mesh::icosphere(0.06, 3).unwrap();
    let with_cavity = hollow(&small, &Mesh::icosphere(0.03, 2).unwrap());
    // 0.2 m below the upper face: the lowest point of the ball is 0.26 m deep.
    let pos12 = Pose::translation(0.05, 0.3, -0.1);
    for (of_large, of_small) in [(200, 3000), (3000, 200)] {
        let block = vps(&large, of_large);
        for mesh in [&small, &with_cavity] {
            for role in [Role::Mixed, Role::Voxelmap, Role::Pointshell, Role::Both] {
                let inner = vps(mesh, of_small).with_role(role);
                check("a VPS ball in a VPS block", &block, &inner, &pos12, 0.26);
                // Turned, and just below the face.
                let turn = Rotation::from_rotation_x(0.8) * Rotation::from_rotation_z(0.6);
                let shallow = Pose::from_parts(Vector::new(0.05, 0.43, -0.1), turn);
                check("a VPS ball below a face", &block, &inner, &shallow, 0.13);
            }
        }
    }
}

#[test]
fn shapes_of_parry_within_are_found_and_hold_what_is_within_them() {
    let block = vps(&cube(1.0), 1000);
    let pos12 = Pose::translation(0.05, 0.3, -0.1);
    let ball = Mesh::icosphere(0.06, 3).unwrap();
    let (vertices, indices) = triangles(&ball);
    let mesh_of = |v: &[Vector], t: &[[u32; 3]]| {
        SharedShape::trimesh_with_flags(v.to_vec(), t.to_vec(), TriMeshFlags::ORIENTED).unwrap()
    };
    let small = [
        ("a ball", SharedShape::ball(0.06)),
        ("a cuboid", SharedShape::cuboid(0.06, 0.06, 0.06)),
        ("a capsule", SharedShape::capsule_y(0.03, 0.03)),
        ("a hull", SharedShape::convex_hull(&vertices).unwrap()),
        ("a mesh", mesh_of(&vertices, &indices)),
        (
            "a compound",
            SharedShape::compound(vec![(Pose::IDENTITY, SharedShape::ball(0.06))]),
        ),
    ];
    for (name, shape) in &small {
        check(name, &block, &**shape, &pos12, 0.26);
    }
    // Smooth, and large beside the spacing of the points.
    let fine = vps(&cube(1.0), 10_000);
    let (vertices, indices) = triangles(&Mesh::icosphere(0.3, 2).unwrap());
    let smooth = mesh_of(&vertices, &indices);
    let at = Vector::new(0.05, 0.1, -0.1);
    let depth = |v: &Vector| 0.5 - f64::from((*v + at).abs().max_element());
    let deepest = vertices.iter().map(depth).fold(0.0, f64::max);
    check(
        "a large mesh",
        &fine,
        &*smooth,
        &Pose::from_translation(at),
        deepest,
    );
    let inner = vps(&ball, 1000);
    let (vertices, indices) = triangles(&cube(1.0));
    let large = [
        ("in a cuboid", SharedShape::cuboid(0.5, 0.5, 0.5)),
        ("in a hull", SharedShape::convex_hull(&vertices).unwrap()),
        ("in a mesh", mesh_of(&vertices, &indices)),
        (
            "in a compound",
            SharedShape::compound(vec![(Pose::IDENTITY, SharedShape::cuboid(0.5, 0.5, 0.5))]),
        ),
    ];
    for (name, shape) in &large {
        check(name, &**shape, &inner, &pos12, 0.26);
    }
    let in_ball = Pose::translation(0.0, 0.5 - 0.2, 0.0);
    check(
        "in a ball",
        &*SharedShape::ball(0.5),
        &inner,
        &in_ball,
        0.26,
    );
}

#[test]
fn in_a_cavity_there_is_no_contact() {
    let case = hollow(&cube(1.0), &cube(0.8));
    let small = Mesh::icosphere(0.06, 3).unwrap();
    // 0.04 m above the floor of the cavity, and in its middle.
    for (y, gap) in [(-0.3, 0.04), (0.0, 0.34)] {
        let pos12 = Pose::translation(0.02, y, 0.01);
        for (of_case, of_small) in [(400, 3000), (6000, 200)] {
            let (outer, inner) = (vps(&case, of_case), vps(&small, of_small));
            check("a VPS ball in a cavity", &outer, &inner, &pos12, -gap);
            check(
                "a ball in a cavity",
                &outer,
                &*SharedShape::ball(0.06),
                &pos12,
                -gap,
            );
        }
    }
}

/// Balls that start five radii deep in a block leave it at the closest face, and stay there.
#[test]
fn a_body_is_pushed_out_of_the_one_it_is_in() {
    let radius = 0.03;
    let block = vps(&cube(1.0), 300);
    let ball = Mesh::icosphere(f64::from(radius), 3).unwrap();
    let balls: [(&str, SharedShape); 3] = [
        ("a VPS ball", vps(&ball, 1000).into()),
        ("a coarse VPS ball", vps(&ball, 100).into()),
        ("a parry ball", SharedShape::ball(radius as Real)),
    ];
    for (name, shape) in &balls {
        for start in [
            Vector::new(0.1, 0.5 - 0.15, 0.05),
            Vector::new(0.0, 0.5 - 0.15, 0.31),
        ] {
            let mut world = PhysicsWorld {
                narrow_phase: narrow_phase(),
                ..PhysicsWorld::default()
            };
            let block = ColliderBuilder::new(block.clone().into());
            world.insert(RigidBodyBuilder::fixed(), block);
            let start = RigidBodyBuilder::dynamic().translation(start);
            let (body, _) = world.insert(start, ColliderBuilder::new(shape.clone()));
            let mut fastest: Real = 0.0;
            let (mut highest, mut steps) = (Real::MIN, 0);
            for step in 0..240 {
                world.step();
                let body = &world.bodies[body];
                fastest = fastest.max(body.linvel().length());
                highest = highest.max(body.translation().y);
                if steps == 0 && body.translation().y > 0.5 {
                    steps = step + 1;
                }
            }
            let end = world.bodies[body].translation();
            assert!(steps > 0, "{name} is still at {end}");
            // Not shot out: no higher above the block than it was deep.
            assert!(
                highest < 0.8 && fastest < 12.0,
                "{name}: {highest} m, {fastest} m/s"
            );
        }
    }
}

#[test]
fn models_can_hold_each_other() {
    // A link in a cup, in its wall here and in its opening there.
    let cup = vps(&models::cup(48), 2000);
    let pin = Mesh::icosphere(0.01, 2).unwrap();
    for points in [50, 4000] {
        let pin = vps(&pin, points);
        let solid = |at: Vector| {
            let dispatcher = VpsDispatcher::default();
            let pose = Pose::from_translation(at);
            dispatcher
                .intersection_test(&pose, &cup, &pin)
                .unwrap()
                .intersecting
        };
        for i in 0..60 {
            let at = Vector::new(0.016 * i as Real, 0.0, -0.1);
            let depth = cup.distance_to_local_point(at, false);
            if depth.abs() > 0.03 {
                assert_eq!(solid(at), depth < 0.0, "{at}: {depth}");
            }
        }
    }
}
