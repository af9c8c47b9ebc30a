//! A ball on level ground, whatever the points of the ground.

// Numbers of rapier are 32-bit or 64-bit.
#![allow(clippy::unnecessary_cast, clippy::useless_conversion)]

use std::sync::Arc;

use vps_build::{BuildOptions, Mesh, PointCount, Resolution, build};
use vps_rapier::rapier3d::prelude::*;
use vps_rapier::{VpsShape, set_up};

const RADIUS: Real = 0.05;

fn grounds() -> [(&'static str, SharedShape); 3] {
    let plate = |thickness, voxel, points| {
        let mesh = Mesh::cuboid([1.0, thickness, 1.0]).unwrap();
        let options = BuildOptions {
            resolution: Resolution::VoxelSize(voxel),
            points: PointCount::About(points),
            ..BuildOptions::default()
        };
        let asset = build(&mesh, &options, &|_| ()).unwrap().asset;
        VpsShape::new(Arc::new(asset)).into()
    };
    [
        ("coarse block", plate(0.1, 0.02, 1000)),
        ("fine block", plate(0.1, 0.01, 10_000)),
        ("thin plate", plate(0.005, 0.0025, 5000)),
    ]
}

/// A world for the ball, with fixed ground.
fn world_on(ground: &SharedShape) -> PhysicsWorld {
    let mut world = PhysicsWorld::default();
    set_up(
        &mut world.narrow_phase,
        &mut world.integration_parameters,
        0.1,
    );
    world.insert(
        RigidBodyBuilder::fixed(),
        ColliderBuilder::new(ground.clone()),
    );
    world
}

#[test]
fn a_ball_dropped_straight_goes_straight() {
    let mut failed = String::new();
    for (ground_name, ground) in grounds() {
        let top = ground.compute_local_aabb().maxs.y;
        for i in 0..6 {
            let mut world = world_on(&ground);
            let height = 0.01 + 0.1 * i as Real;
            let at = Vector::new(0.13 - 0.021 * i as Real, top + RADIUS + height, 0.07);
            let start = RigidBodyBuilder::dynamic().translation(at);
            let (body, _) = world.insert(start, ColliderBuilder::ball(RADIUS));
            let mut aside: Real = 0.0;
            for _ in 0..90 {
                world.step();
                let v = world.bodies[body].linvel();
                aside = aside.max((v.x * v.x + v.z * v.z).sqrt());
            }
            let off = world.bodies[body].translation().y - top - RADIUS;
            if aside > 0.02 || off.abs() > 0.002 {
                failed += &format!(
                    "{ground_name}, from {height:.2} m: {aside:.3} m/s aside, {:.2} mm off\n",
                    off * 1e3
                );
            }
        }
    }
    assert!(failed.is_empty(), "{failed}");
}

/// A ball of facets of 0.9 mm that rolls at 1 m/s keeps its spin.
#[test]
fn a_ball_rolls_on() {
    let mesh = Mesh::icosphere(f64::from(RADIUS as f32), 6).unwrap();
    let mut failed = String::new();
    for points in [500, 5000] {
        let options = BuildOptions {
            resolution: Resolution::VoxelsAlongLongest(40),
            points: PointCount::About(points),
            ..BuildOptions::default()
        };
        let asset = Arc::new(build(&mesh, &options, &|_| ()).unwrap().asset);
        let ball = SharedShape::new(VpsShape::new(asset));
        let spin = 20.0;
        let mut world = world_on(&SharedShape::cuboid(5.0, 0.1, 0.5));
        let start = RigidBodyBuilder::dynamic()
            .translation(Vector::new(-4.0, 0.1 + RADIUS, 0.0))
            .linvel(Vector::X * (spin * RADIUS))
            .angvel(Vector::new(0.0, 0.0, -spin));
        let (body, _) = world.insert(start, ColliderBuilder::new(ball.clone()));
        for _ in 0..240 {
            world.step();
        }
        let left = -world.bodies[body].angvel().z / spin;
        if !(0.98..1.05).contains(&left) {
            failed += &format!("{points} points: {left:.3} of the spin is left\n");
        }
    }
    assert!(failed.is_empty(), "{failed}");
}
