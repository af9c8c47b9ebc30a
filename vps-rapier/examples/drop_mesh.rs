//! Drops a mesh on the ground: `cargo run --release --example drop_mesh -- MESH` takes an OBJ, PLY,
//! STL or OFF file in metres, without one a trefoil knot made by code.

use std::error::Error;
use std::path::Path;

use vps_rapier::rapier3d::prelude::*;
use vps_rapier::vps_build::models;
use vps_rapier::{VpsShapeBuilder, set_up};

fn main() -> Result<(), Box<dyn Error>> {
    let builder = match std::env::args().nth(1) {
        Some(path) => VpsShapeBuilder::from_mesh_file(Path::new(&path), None)?,
        None => VpsShapeBuilder::new(models::trefoil_knot(48)),
    };
    // Built once, then read from the folder.
    let cache = std::env::temp_dir().join("vps-rapier-examples");
    let shape = builder.cached_in(&cache).build()?;
    let size = shape.compute_local_aabb().extents().max_element();
    println!(
        "{} points {:.4} m apart, {:.3} m³",
        shape.asset().tree.point_count(),
        shape.spacing(),
        shape.asset().mass.volume
    );

    let mut world = PhysicsWorld::default();
    set_up(
        &mut world.narrow_phase,
        &mut world.integration_parameters,
        size,
    );
    let ground = ColliderBuilder::cuboid(10.0 * size, 0.5 * size, 10.0 * size);
    world.insert(
        RigidBodyBuilder::fixed().translation(-0.5 * size * Vector::Y),
        ground,
    );
    let above = RigidBodyBuilder::dynamic().translation(1.5 * size * Vector::Y);
    let (body, _) = world.insert(above, ColliderBuilder::new(shape.into()));
    for step in 0..=240 {
        if step % 30 == 0 {
            let body = &world.bodies[body];
            println!(
                "{:.1} s: centre {:.4} m above the ground, {:.4} m/s",
                step as f32 / 60.0,
                body.center_of_mass().y,
                body.linvel().length()
            );
        }
        world.step();
    }
    Ok(())
}
