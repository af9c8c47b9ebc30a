//! rapier's character controller, on VPS shapes and with one as the character, against the same
//! among shapes of parry.

// Numbers of rapier are 32-bit or 64-bit.
#![allow(clippy::unnecessary_cast, clippy::useless_conversion)]

mod support;

use std::sync::Arc;

use glamx::{DQuat, DVec3};
use support::asset;
use vps_build::{BuildOptions, Mesh, PointCount, Resolution, build};
use vps_rapier::rapier3d::control::{EffectiveCharacterMovement, KinematicCharacterController};
use vps_rapier::rapier3d::parry::query::ShapeCastOptions;
use vps_rapier::rapier3d::prelude::*;
use vps_rapier::{VpsShape, narrow_phase};

/// Centres and edges of the boxes of a ground in metres, and their rotations about z: a floor, a ramp
/// and a wall at the end of the ramp.
const GROUND: [([f64; 3], [f64; 3], f64); 3] = [
    ([0.0, -0.1, 0.0], [4.0, 0.2, 1.6], 0.0),
    ([0.8, 0.1, 0.0], [2.0, 0.2, 1.6], 0.3),
    ([1.7, 0.6, 0.0], [0.6, 1.6, 1.6], 0.0),
];

/// Radius of a capsule, in metres.
const RADIUS: Real = 0.2;
/// Distance from its centre to the centres of its ends.
const HALF: Real = 0.3;

const DT: Real = 1.0 / 60.0;

fn vector(v: [f64; 3]) -> Vector {
    Vector::from_array(v.map(|c| c as Real))
}

fn cuboid(extents: [f64; 3]) -> SharedShape {
    let half = vector(extents) * 0.5;
    SharedShape::cuboid(half.x, half.y, half.z)
}

fn vps_cuboid(extents: [f64; 3]) -> SharedShape {
    VpsShape::new(asset(&Mesh::cuboid(extents).unwrap(), 3000)).into()
}

/// The ground as a compound of parry.
fn boxes() -> SharedShape {
    let parts = GROUND.map(|(center, extents, angle)| {
        let turned = Rotation::from_rotation_z(angle as Real);
        (Pose::from_parts(vector(center), turned), cuboid(extents))
    });
    SharedShape::compound(parts.to_vec())
}

/// The ground as one concave VPS shape.
fn vps_ground() -> SharedShape {
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for (center, extents, angle) in GROUND {
        let part = Mesh::cuboid(extents).unwrap();
        let first = vertices.len() as u32;
        let place = |&v: &DVec3| DQuat::from_rotation_z(angle) * v + DVec3::from(center);
        vertices.extend(part.vertices().iter().map(place));
        triangles.extend(part.triangles().iter().map(|t| t.map(|i| first + i)));
    }
    let mesh = Mesh::new(&vertices, &triangles).unwrap();
    // Normals of the shell are differences over two voxels, so they tilt within two of the ramp.
    let options = BuildOptions {
        resolution: Resolution::VoxelSize(0.05),
        points: PointCount::About(8000),
        ..BuildOptions::default()
    };
    VpsShape::new(Arc::new(build(&mesh, &options, &|_| ()).unwrap().asset)).into()
}

fn capsule() -> SharedShape {
    SharedShape::capsule_y(HALF, RADIUS)
}

/// The same capsule with balls in its ends, whose contacts with a VPS shape the controller sees.
fn capsule_with_balls() -> SharedShape {
    let ball = SharedShape::ball(RADIUS);
    SharedShape::compound(vec![
        (Pose::IDENTITY, capsule()),
        (Pose::translation(0.0, -HALF, 0.0), ball.clone()),
        (Pose::translation(0.0, HALF, 0.0), ball),
    ])
}

fn world_of(body: RigidBodyBuilder, shape: &SharedShape) -> (PhysicsWorld, RigidBodyHandle) {
    let mut world = PhysicsWorld {
        narrow_phase: narrow_phase(),
        ..PhysicsWorld::default()
    };
    let (body, _) = world.insert(body, ColliderBuilder::new(shape.clone()));
    world.step();
    (world, body)
}

/// Moves a character in steps from a starting pose; `step` may change the world.
fn moves(
    world: &mut PhysicsWorld,
    character: &SharedShape,
    at: &mut Pose,
    displacement: Vector,
    mut step: impl FnMut(&mut PhysicsWorld),
) -> Vec<(Vector, EffectiveCharacterMovement)> {
    let controller = KinematicCharacterController::default();
    let mut moves = Vec::new();
    for _ in 0..240 {
        let queries = world.query_pipeline();
        let moved = controller.move_shape(DT, &queries, &**character, at, displacement, |_| ());
        at.translation += moved.translation;
        moves.push((at.translation, moved));
        step(world);
    }
    moves
}

/// Walks for 4 s towards +x and down, at 1 m/s each.
fn walk(
    ground: &SharedShape,
    character: &SharedShape,
) -> Vec<(Vector, EffectiveCharacterMovement)> {
    let (mut world, _) = world_of(RigidBodyBuilder::fixed(), ground);
    let start = RADIUS + HALF + 0.05;
    let mut at = Pose::translation(-1.5, start, 0.0);
    moves(
        &mut world,
        character,
        &mut at,
        Vector::new(DT, -DT, 0.0),
        |_| (),
    )
}

/// The largest distance between two walks, in metres, and the share of steps on the ground.
fn compared(
    walk: &[(Vector, EffectiveCharacterMovement)],
    expected: &[(Vector, EffectiveCharacterMovement)],
) -> (Real, Real) {
    let pairs = walk.iter().zip(expected);
    let away = pairs.map(|((at, _), (expected, _))| at.distance(*expected));
    let grounded = walk.iter().filter(|(_, moved)| moved.grounded).count();
    let share = grounded as Real / walk.len() as Real;
    (away.fold(0.0, Real::max), share)
}

#[test]
fn characters_walk_as_among_shapes_of_parry() {
    let ball = SharedShape::ball(RADIUS);
    let mesh = Mesh::icosphere(f64::from(RADIUS), 4).unwrap();
    let vps_ball: SharedShape = VpsShape::new(asset(&mesh, 3000)).into();
    let vps_ball_on_ball = SharedShape::compound(vec![
        (Pose::IDENTITY, vps_ball.clone()),
        (Pose::IDENTITY, ball.clone()),
    ]);
    let (boxes, ours) = (boxes(), vps_ground());
    let by_parry = [capsule(), ball.clone()].map(|character| walk(&boxes, &character));
    for (expected, least_x) in by_parry.iter().zip([1.15, 1.15]) {
        let (at, _) = expected.last().unwrap();
        assert!(at.x > least_x && at.x < 1.25, "by parry: {at}");
    }
    // The balls by which the controller sees that it stands on something.
    let walks = [
        ("capsule on VPS", &ours, capsule(), 0, false),
        (
            "capsule with balls on VPS",
            &ours,
            capsule_with_balls(),
            0,
            true,
        ),
        ("ball on VPS", &ours, ball, 1, true),
        ("VPS on boxes", &boxes, vps_ball.clone(), 1, false),
        (
            "VPS with a ball on boxes",
            &boxes,
            vps_ball_on_ball,
            1,
            true,
        ),
        ("VPS on VPS", &ours, vps_ball, 1, false),
    ];
    for (name, ground, character, expected, sees) in walks {
        let walk = walk(ground, &character);
        let (away, grounded) = compared(&walk, &by_parry[expected]);
        assert!(away < 0.08, "{name}: {away} m away");
        assert!(!sees || grounded > 0.9, "{name}: on the ground {grounded}");
    }
}

#[test]
fn a_moving_vps_platform_carries_a_character_with_balls() {
    let platform = vps_cuboid([2.0, 0.2, 2.0]);
    let body = RigidBodyBuilder::kinematic_velocity_based().linvel(Vector::X * 0.5);
    let (mut world, body) = world_of(body, &platform);
    let mut at = Pose::translation(0.0, RADIUS + HALF + 0.11, 0.0);
    let down = -Vector::Y * DT;
    moves(
        &mut world,
        &capsule_with_balls(),
        &mut at,
        down,
        PhysicsWorld::step,
    );
    let carried = world.bodies[body].translation().x;
    assert!(carried > 1.9, "{carried}");
    let off = at.translation - Vector::new(carried, RADIUS + HALF + 0.11, 0.0);
    assert!(off.length() < 0.02, "{} for {carried}", at.translation);
}

/// The speed of a crate that a character runs into.
fn pushed(crate_shape: &SharedShape) -> Real {
    let body = RigidBodyBuilder::dynamic().gravity_scale(0.0);
    let (mut world, body) = world_of(body, crate_shape);
    let controller = KinematicCharacterController::default();
    let character = capsule_with_balls();
    let mut at = Pose::translation(-0.5, 0.0, 0.0);
    for _ in 0..10 {
        let mut hits = Vec::new();
        let queries = world.query_pipeline();
        let ahead = Vector::X * DT;
        let moved =
            controller.move_shape(DT, &queries, &*character, &at, ahead, |hit| hits.push(hit));
        at.translation += moved.translation;
        let mut queries = world.broad_phase.as_query_pipeline_mut(
            world.narrow_phase.query_dispatcher(),
            &mut world.bodies,
            &mut world.colliders,
            QueryFilter::default(),
        );
        controller.solve_character_collision_impulses(DT, &mut queries, &*character, 10.0, &hits);
    }
    world.bodies[body].linvel().x
}

#[test]
fn a_character_with_balls_pushes_vps_bodies() {
    let ours = pushed(&vps_cuboid([0.5; 3]));
    let by_parry = pushed(&cuboid([0.5; 3]));
    assert!(by_parry > 0.9, "{by_parry} m/s by parry");
    assert!(
        ours > 0.9 && ours < 1.1 * by_parry,
        "{ours} m/s, {by_parry} by parry"
    );
}

/// A fast cast along a floor, with less room than the target distance, meets the wall at its end.
#[test]
fn a_body_that_slides_along_a_floor_meets_the_wall() {
    let (world, _) = world_of(RigidBodyBuilder::fixed(), &vps_ground());
    let ball = SharedShape::ball(0.05);
    for height in [0.045, 0.05, 0.055, 0.062, 0.1] {
        for stop_at_penetration in [false, true] {
            let options = ShapeCastOptions {
                target_distance: 0.01,
                stop_at_penetration,
                ..ShapeCastOptions::with_max_time_of_impact(4.0)
            };
            let start = Pose::translation(-1.8, height, 0.0);
            let hit = world
                .query_pipeline()
                .cast_shape(&start, Vector::X, &*ball, options);
            let (_, hit) = hit.unwrap();
            let at_once = stop_at_penetration && height < 0.06;
            // Where the ramp, 0.3 steep and 0 high at 0.138 m, is the target distance away.
            let steep = 0.3_f64.tan() as Real;
            let room = 0.06 * (1.0 + steep * steep).sqrt();
            let ramp = 1.8 + 0.138 + (height as Real - room) / steep;
            let expected = if at_once { 0.0 } else { ramp };
            let off = (hit.time_of_impact - expected).abs();
            // Two voxels.
            assert!(
                off < 0.1,
                "{height}, {stop_at_penetration}: {hit:?} not {expected}"
            );
        }
    }
}
