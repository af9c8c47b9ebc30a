//! A world that was saved and read continues as the original.

// Numbers of rapier are 32-bit or 64-bit.
#![allow(clippy::unnecessary_cast, clippy::useless_conversion)]

mod support;

use std::path::PathBuf;

use support::{asset, state};
use vps_build::{Mesh, models};
use vps_rapier::rapier3d::prelude::*;
use vps_rapier::{Role, Snapshot, VpsShape, check, narrow_phase};

/// A file of a test, removed on drop.
struct File(PathBuf);

impl Drop for File {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}

fn world(clustering: bool) -> PhysicsWorld {
    let mut world = PhysicsWorld {
        narrow_phase: narrow_phase(),
        ..PhysicsWorld::default()
    };
    world.integration_parameters.contact_clustering = clustering;
    let ground = ColliderBuilder::cuboid(4.0, 0.1, 4.0);
    world.insert(RigidBodyBuilder::fixed(), ground);
    // A step of triangles, so that there are pairs of compounds and meshes.
    let corners = [
        [-4.0, 0.1, 0.0],
        [-4.0, 0.1, 4.0],
        [4.0, 0.3, 4.0],
        [4.0, 0.3, 0.0],
    ];
    let corners = corners.map(|[x, y, z]| Vector::new(x, y, z)).to_vec();
    let slope = SharedShape::trimesh(corners, vec![[0, 1, 2], [0, 2, 3]]).unwrap();
    world.insert(RigidBodyBuilder::fixed(), ColliderBuilder::new(slope));
    world
}

fn drop_all(world: &mut PhysicsWorld, shapes: &[SharedShape]) {
    for (i, shape) in shapes.iter().enumerate() {
        let i = i as Real;
        let start = RigidBodyBuilder::dynamic()
            .translation(Vector::new(0.2 * i, 0.9 + 0.5 * i, 0.3 - 0.2 * i))
            .rotation(Vector::new(0.4 * i, 0.3, 0.2 * i));
        world.insert(start, ColliderBuilder::new(shape.clone()));
    }
}

/// Steps a world, saves and reads it, and steps both: the first step after which they differ.
fn first_difference(mut world: PhysicsWorld, before: usize) -> Option<usize> {
    for _ in 0..before {
        world.step();
    }
    let text = serde_json::to_string(&Snapshot::of(&world)).unwrap();
    let read: Snapshot = serde_json::from_str(&text).unwrap();
    let mut second = read.restore().unwrap();
    check(
        &second.narrow_phase,
        &second.integration_parameters,
        &second.colliders,
    )
    .unwrap();
    (0..200).find(|_| {
        world.step();
        second.step();
        state(&world) != state(&second)
    })
}

#[test]
fn a_saved_world_goes_on_to_the_bit() {
    let gear = VpsShape::new(asset(&models::gear(12), 1000));
    let file = File(std::env::temp_dir().join(format!("vps-snapshot-{}.vps", std::process::id())));
    vps_build::write_asset(&file.0, &asset(&models::torus(16), 500)).unwrap();
    let ring = VpsShape::from_file(&file.0).unwrap().with_role(Role::Both);
    let block: SharedShape = VpsShape::new(asset(&Mesh::cuboid([0.3; 3]).unwrap(), 500)).into();
    let compound = SharedShape::compound(vec![
        (Pose::translation(-0.2, 0.0, 0.0), block),
        (
            Pose::translation(0.3, 0.0, 0.0),
            SharedShape::cuboid(0.2, 0.1, 0.1),
        ),
    ]);
    let ours = [gear.clone().into(), ring.into(), compound, gear.into()];
    let parrys = [
        SharedShape::cuboid(0.3, 0.1, 0.3),
        SharedShape::cylinder(0.1, 0.3),
        SharedShape::compound(vec![
            (Pose::translation(-0.2, 0.0, 0.0), SharedShape::ball(0.2)),
            (
                Pose::translation(0.3, 0.0, 0.0),
                SharedShape::cuboid(0.2, 0.1, 0.1),
            ),
        ]),
    ];
    // Before anything moved, in flight, when all have landed, and at rest.
    for before in [0, 20, 60, 300] {
        for (name, shapes) in [("parry's", &parrys[..]), ("VPS", &ours[..])] {
            let mut world = world(false);
            drop_all(&mut world, shapes);
            let difference = first_difference(world, before);
            assert_eq!(
                difference, None,
                "{name} shapes, saved after {before} steps"
            );
        }
    }
}

#[test]
fn a_saved_world_with_clusters_is_as_good_as_one_of_parry() {
    let gear: SharedShape = VpsShape::new(asset(&models::gear(12), 1000)).into();
    let mut world = world(true);
    drop_all(&mut world, &[gear.clone(), gear]);
    for _ in 0..60 {
        world.step();
    }
    let text = serde_json::to_string(&Snapshot::of(&world)).unwrap();
    let read: Snapshot = serde_json::from_str(&text).unwrap();
    let mut second = read.restore().unwrap();
    for _ in 0..100 {
        world.step();
        second.step();
    }
    let places = |w: &PhysicsWorld| -> Vec<Vector> {
        w.bodies
            .iter()
            .map(|(_, body)| body.translation())
            .collect()
    };
    for (a, b) in places(&world).into_iter().zip(places(&second)) {
        assert!((a - b).length() < 0.05, "{a} {b}");
    }
}

#[test]
fn changes_before_a_snapshot_survive_it() {
    let block: SharedShape = VpsShape::new(asset(&Mesh::cuboid([0.3; 3]).unwrap(), 500)).into();
    let mut world = world(false);
    drop_all(&mut world, &[block]);
    for _ in 0..60 {
        world.step();
    }
    let (handle, _) = world.bodies.iter().find(|(_, b)| b.is_dynamic()).unwrap();
    world.bodies[handle].set_translation(Vector::new(1.0, 2.0, 1.0), true);
    assert_eq!(first_difference(world, 0), None);
}
