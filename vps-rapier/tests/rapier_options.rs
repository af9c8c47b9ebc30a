//! The behaviour under rapier's options, and results that must not depend on them.

// Numbers of rapier are 32-bit or 64-bit.
#![allow(clippy::unnecessary_cast, clippy::useless_conversion)]

mod support;

use support::{asset, state};
use vps_build::{Mesh, models};
use vps_rapier::rapier3d::prelude::*;
use vps_rapier::{VpsShape, narrow_phase};

fn empty_world() -> PhysicsWorld {
    PhysicsWorld {
        narrow_phase: narrow_phase(),
        ..PhysicsWorld::default()
    }
}

/// A heap of gears after it fell for some steps on a ground of parry.
fn heap(change: impl Fn(&mut PhysicsWorld), steps: usize) -> PhysicsWorld {
    let gear = asset(&models::gear(12), 2000);
    // Tall and round bodies would roll on and rock, as parry's own do.
    let mut world = empty_world();
    change(&mut world);
    world.insert(
        RigidBodyBuilder::fixed(),
        ColliderBuilder::cuboid(40.0, 0.1, 40.0),
    );
    for i in 0..5 {
        let i = i as Real;
        let start = RigidBodyBuilder::dynamic()
            .translation(Vector::new(0.1 * i, 1.8 + 0.6 * i, 0.05 * i))
            .rotation(Vector::new(0.4 * i, 0.3, 0.2 * i))
            .angular_damping(1.0);
        world.insert(
            start,
            ColliderBuilder::new(VpsShape::new(gear.clone()).into()),
        );
    }
    for _ in 0..steps {
        world.step();
    }
    world
}

#[test]
fn runs_are_the_same_bit_for_bit_for_any_number_of_threads() {
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build().unwrap().install(|| state(&heap(|_| (), 150)))
    };
    let one = run(1);
    assert!(one.iter().any(|&bits| bits != 0));
    assert_eq!(one, run(1));
    assert_eq!(one, run(2));
}

#[test]
fn a_heap_comes_to_rest_with_every_switch() {
    type Switch = fn(&mut PhysicsWorld);
    let switches: [(&str, Switch); 4] = [
        ("as it is", |_| ()),
        ("no recycling", |w| {
            w.integration_parameters.contact_recycling = false;
        }),
        ("no clustering", |w| {
            w.integration_parameters.contact_clustering = false;
        }),
        ("neither", |w| {
            w.integration_parameters.contact_recycling = false;
            w.integration_parameters.contact_clustering = false;
        }),
    ];
    for (name, switch) in switches {
        let world = heap(switch, 600);
        for (_, body) in world.bodies.iter().filter(|(_, b)| b.is_dynamic()) {
            let (y, speed) = (body.translation().y, body.linvel().length());
            assert!(y > 0.1, "{name}: a body at {y}");
            // Clusters lose impulses when their number changes, which recycling hides.
            let most = if name == "no recycling" { 0.5 } else { 0.01 };
            assert!(speed < most, "{name}: a body at {speed} m/s");
        }
    }
}

/// Signed distance of a fast body from a heavy plate it could pass between two steps.
fn shot(
    body: &SharedShape,
    plate: &SharedShape,
    plate_body: RigidBodyBuilder,
    ccd: fn(RigidBodyBuilder) -> RigidBodyBuilder,
) -> Real {
    let mut world = empty_world();
    world.gravity = Vector::ZERO;
    let plate = ColliderBuilder::new(plate.clone()).density(1e6);
    world.insert(plate_body, plate);
    let start = RigidBodyBuilder::dynamic()
        .translation(Vector::new(0.02, 1.5, 0.01))
        .linvel(Vector::new(0.0, -60.0, 0.0));
    let (body, _) = world.insert(ccd(start), ColliderBuilder::new(body.clone()));
    for _ in 0..30 {
        world.step();
    }
    world.bodies[body].translation().y
}

#[test]
fn fast_bodies_are_held_by_ccd() {
    let small: SharedShape = VpsShape::new(asset(&Mesh::cuboid([0.1; 3]).unwrap(), 600)).into();
    let plate = Mesh::cuboid([0.5, 0.02, 0.5]).unwrap();
    let plate: SharedShape = VpsShape::new(asset(&plate, 4000)).into();
    let thin = SharedShape::cuboid(0.25, 0.01, 0.25);
    let pairs = [
        ("VPS on VPS", small.clone(), plate.clone()),
        ("VPS on cuboid", small, thin),
        ("ball on VPS", SharedShape::ball(0.05), plate.clone()),
        (
            "cuboid on VPS",
            SharedShape::cuboid(0.05, 0.05, 0.05),
            plate,
        ),
    ];
    for (name, body, plate) in pairs {
        let (free, fixed) = (RigidBodyBuilder::dynamic, RigidBodyBuilder::fixed);
        let without = shot(&body, &plate, free(), |b| b);
        assert!(without < -0.5, "{name} is held without: {without}");
        let with = shot(&body, &plate, free(), |b| b.ccd_enabled(true));
        assert!(with > 0.0, "{name} with CCD at {with}");
        // A fixed plate holds without CCD of the body.
        let on_fixed = shot(&body, &plate, fixed(), |b| b);
        assert!(on_fixed > 0.0, "{name}, fixed, at {on_fixed}");
        let soft = shot(&body, &plate, fixed(), |b| b.soft_ccd_prediction(2.0));
        assert!(soft > 0.0, "{name} with soft CCD at {soft}");
    }
}

#[test]
fn a_sensor_sees_what_is_in_it_and_holds_nothing() {
    let cup = VpsShape::new(asset(&models::cup(24), 3000));
    let mut world = empty_world();
    let sensor = ColliderBuilder::new(cup.into()).sensor(true);
    let (_, sensor) = world.insert(RigidBodyBuilder::fixed(), sensor);
    let start = RigidBodyBuilder::dynamic().translation(Vector::new(0.0, 2.0, 0.0));
    let (ball, collider) = world.insert(start, ColliderBuilder::ball(0.1));
    let mut seen = 0;
    for _ in 0..90 {
        world.step();
        seen += u32::from(world.narrow_phase.intersection_pair(sensor, collider) == Some(true));
    }
    assert!(seen > 2, "{seen}");
    assert!(world.bodies[ball].translation().y < -2.0);
}
