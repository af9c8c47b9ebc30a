//! A nut without friction screws itself down a bolt, which convex parts cannot do.
//! `cargo run --release --example bolt_and_nut`.

use std::error::Error;

use vps_rapier::rapier3d::prelude::*;
use vps_rapier::vps_build::models::{self, Thread};
use vps_rapier::{VpsShapeBuilder, set_up};

fn main() -> Result<(), Box<dyn Error>> {
    let (thread, scale) = (Thread::default(), 0.3);
    let pitch = (thread.pitch * scale) as f32;
    let bolt = models::bolt(thread, 1.0, 48).scaled(scale)?;
    let nut = models::nut(thread, 0.2, 0.008, 48).scaled(scale)?;
    let across_flats = 3.6 * (thread.radius * scale) as f32;

    let mut world = PhysicsWorld::default();
    set_up(
        &mut world.narrow_phase,
        &mut world.integration_parameters,
        across_flats,
    );
    // Their axis is z.
    world.gravity = -Vector::Z * 9.81;
    let smooth = |shape: VpsShapeBuilder| -> Result<ColliderBuilder, Box<dyn Error>> {
        Ok(ColliderBuilder::new(shape.build()?.into())
            .friction(0.0)
            .density(1000.0))
    };
    world.insert(
        RigidBodyBuilder::fixed(),
        smooth(VpsShapeBuilder::new(bolt))?,
    );
    let start = RigidBodyBuilder::dynamic().translation(Vector::Z * (2.0 * pitch));
    let (nut, _) = world.insert(start, smooth(VpsShapeBuilder::new(nut))?);
    let mut turns = 0.0;
    for step in 1..=90 {
        world.step();
        let nut = &world.bodies[nut];
        turns += nut.angvel().z / 60.0 / std::f32::consts::TAU;
        if step % 10 == 0 {
            println!(
                "{:.2} s: {turns:.2} turns, {:.1} mm up",
                step as f32 / 60.0,
                1e3 * nut.translation().z
            );
        }
    }
    println!("a turn should lower it by {:.1} mm", 1e3 * pitch);
    Ok(())
}
