//! A pile of knots, whose convex hulls are almost balls:
//! `cargo run --release --example pile -- 60`.

use std::error::Error;
use std::time::Instant;

use vps_rapier::rapier3d::prelude::*;
use vps_rapier::vps_build::{BuildOptions, PointCount, Resolution, models};
use vps_rapier::{VpsShapeBuilder, set_up};

fn main() -> Result<(), Box<dyn Error>> {
    let count: usize = match std::env::args().nth(1) {
        Some(count) => count.parse()?,
        None => 60,
    };
    let shape = VpsShapeBuilder::new(models::trefoil_knot(48))
        .options(BuildOptions {
            resolution: Resolution::VoxelsAlongLongest(60),
            points: PointCount::About(2000),
            ..BuildOptions::default()
        })
        .build()?;
    let mut world = PhysicsWorld::default();
    // A knot is a metre wide.
    set_up(
        &mut world.narrow_phase,
        &mut world.integration_parameters,
        1.0,
    );
    // A bin of five boxes.
    let bin = world.bodies.insert(RigidBodyBuilder::fixed());
    let walls = [
        (Vector::ZERO, Vector::new(2.2, 0.1, 2.2)),
        (Vector::new(2.1, 4.0, 0.0), Vector::new(0.1, 4.0, 2.2)),
        (Vector::new(-2.1, 4.0, 0.0), Vector::new(0.1, 4.0, 2.2)),
        (Vector::new(0.0, 4.0, 2.1), Vector::new(2.2, 4.0, 0.1)),
        (Vector::new(0.0, 4.0, -2.1), Vector::new(2.2, 4.0, 0.1)),
    ];
    for (center, half) in walls {
        let wall = ColliderBuilder::cuboid(half.x, half.y, half.z).translation(center);
        world
            .colliders
            .insert_with_parent(wall, bin, &mut world.bodies);
    }
    // Cloning a shape shares its asset.
    for i in 0..count {
        let (column, row) = (i % 9, i / 9);
        let place = Vector::new(
            (column % 3) as f32 * 1.2 - 1.2,
            1.0 + row as f32 * 1.1,
            (column / 3) as f32 * 1.2 - 1.2,
        );
        let start = RigidBodyBuilder::dynamic()
            .translation(place)
            .rotation(Vector::new(i as f32, 0.7 * i as f32, 0.3));
        world.insert(start, ColliderBuilder::new(shape.clone().into()));
    }
    let speed = |world: &PhysicsWorld| {
        let speeds = world.bodies.iter().map(|(_, b)| b.linvel().length());
        speeds.fold(0.0, f32::max)
    };
    for second in 1..=8 {
        let start = Instant::now();
        for _ in 0..60 {
            world.step();
        }
        println!(
            "{second} s: {:.0} steps per second, fastest body {:.3} m/s",
            60.0 / start.elapsed().as_secs_f64(),
            speed(&world)
        );
    }
    Ok(())
}
