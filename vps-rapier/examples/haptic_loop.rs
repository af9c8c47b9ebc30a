//! A haptic loop of 1 kHz: a peg on a device, here a scripted one, goes into a ring and is pressed
//! against its inside, all around. `cargo run --release --example haptic_loop -- 2`, for 2 seconds.

use std::error::Error;
use std::f32::consts::TAU;
use std::hint::{black_box, spin_loop};
use std::thread::sleep;
use std::time::{Duration, Instant};

use vps_rapier::vps_build::{BuildOptions, Mesh, PointCount, models};
use vps_rapier::vps_core::{
    CouplingOptions, Pose3, Quat, Query, Tool, Vec3, VirtualCoupling, Weight, Wrench,
};
use vps_rapier::{VpsShape, VpsShapeBuilder};

/// Time of a cycle.
const PERIOD: Duration = Duration::from_millis(1);
/// The same in seconds.
const DT: f32 = 1e-3;
/// Time before a deadline in which the loop spins instead of sleeping: a system may wake a thread this
/// much too late.
const AWAKE: Duration = Duration::from_micros(200);
/// Stiffness of the contacts, in N for each m² that is a metre deep.
const CONTACT_STIFFNESS: f32 = 1e9;

fn main() -> Result<(), Box<dyn Error>> {
    let seconds: u32 = match std::env::args().nth(1) {
        Some(seconds) => seconds.parse()?,
        None => 2,
    };
    // The moving body is the shell, the other the voxelmap. Both are along the z axis.
    let peg = shape(models::peg(48).scaled(0.08)?, 3000)?;
    let ring = shape(models::torus(48).scaled(0.08)?, 1000)?;
    let (tree, field) = (&peg.asset().tree, ring.asset().voxelmap.trilinear());

    // A light tool is felt less than a heavy one. Desktop devices bear 1000 N/m and 2 N m/rad.
    let tool = Tool::of(&peg.asset().mass, 0.05);
    let options = CouplingOptions::critically_damped(&tool, 1000.0, 2.0);
    let mut coupling = VirtualCoupling::new(tool, options, device(0.0))?;

    let (mut max_force_n, mut touching, mut missed) = (0.0_f32, 0, 0);
    let (mut longest, mut latest) = (Duration::ZERO, Duration::ZERO);
    let cycles = seconds * 1000;
    let start = Instant::now() + PERIOD;
    for cycle in 0..cycles {
        let due = start + cycle * PERIOD;
        wait_until(due);
        let began = Instant::now();

        let device = device(cycle as f32 * DT);
        // The ring's frame is the world; of another, `ring_pose.inv_mul(&pose)`, and the wrench
        // is turned by the rotation of `pose` all the same.
        let pose = coupling.pose();
        let contact = Query::new(tree, &field, pose).linear_wrench(tool.center, Weight::Area);
        let contact = (contact * CONTACT_STIFFNESS).rotated(pose.rotation);
        touching += u32::from(contact.wrench.force != Vec3::ZERO);
        // A wrench that is not finite is refused: the device keeps the last good one.
        let wrench = match coupling.step(device, contact, DT) {
            Ok(wrench) => wrench,
            Err(_) => coupling.rendered(),
        };
        exert(wrench);

        (longest, latest) = (longest.max(began.elapsed()), latest.max(began - due));
        missed += u32::from(Instant::now() > due + PERIOD);
        max_force_n = max_force_n.max(wrench.force.length());
    }
    println!("{cycles} cycles, the peg touching the ring in {touching}");
    println!("largest force: {max_force_n:.2} N");
    println!("longest cycle: {} µs", longest.as_micros());
    println!(
        "missed deadlines: {missed}; the system was up to {} µs late",
        latest.as_micros()
    );
    Ok(())
}

/// A shape of about `points` points.
fn shape(mesh: Mesh, points: u32) -> Result<VpsShape, Box<dyn Error>> {
    let options = BuildOptions {
        points: PointCount::About(points),
        ..BuildOptions::default()
    };
    Ok(VpsShapeBuilder::new(mesh).options(options).build()?)
}

/// The pose the user wants for the peg: from below into the ring, then around in it, tilted and 4 mm
/// further aside than there is room. A true device is asked here.
fn device(time: f32) -> Pose3 {
    let progress = (2.0 * time).min(1.0);
    let aside = 0.012 * (2.0 * time - 1.0).clamp(0.0, 1.0);
    let (sin, cos) = (TAU * time).sin_cos();
    let position = Vec3::new(aside * cos, aside * sin, 0.1 * (progress - 1.0));
    Pose3::from_parts(position, Quat::from_rotation_x(10.0 * aside * sin))
}

/// Sends force and torque to the device; the scripted one ignores them.
fn exert(wrench: Wrench) {
    black_box(wrench);
}

/// Sleeps until a moment, and spins at the end.
fn wait_until(due: Instant) {
    let asleep = due.saturating_duration_since(Instant::now() + AWAKE);
    if !asleep.is_zero() {
        sleep(asleep);
    }
    while Instant::now() < due {
        spin_loop();
    }
}
