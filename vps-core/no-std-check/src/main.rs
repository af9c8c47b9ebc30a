//! Queries on an asset in constant memory. Exits with 0 if all results are right, otherwise with the
//! number of the failed check.

#![no_std]
#![no_main]

use vps_core::{
    Asset, Body, BodyPair, CouplingOptions, Cuboid, DistanceField, Pose3, Query, Shells, Sweep,
    Tool, Vec3, VirtualCoupling, Weight, Work,
};

// For its start-up code alone, which calls `main`.
#[link(name = "c")]
unsafe extern "C" {}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {}
}

/// A torus around the z axis, about a metre wide, written by an example of the builder.
static TORUS: &[u8] = vps_core::include_asset!("../../../target/torus.vps");

/// Runs all checks; the error is the number of the first one that fails.
fn check() -> Result<(), i32> {
    let is = |right: bool, number: i32| if right { Ok(()) } else { Err(number) };
    let torus = Asset::from_bytes(TORUS).map_err(|_| 1)?;
    let field = torus.voxelmap.trilinear();
    let ground = Cuboid::new(Vec3::new(2.0, 2.0, 0.1));
    let half_height = torus.voxelmap.solid().extents().z * 0.5;

    // Lying on the ground, a centimetre deep.
    let height = 0.1 + half_height - 0.01;
    let lying = Pose3::from_translation(Vec3::new(0.0, 0.0, height));
    let query = Query::new(&torus.tree, &ground, lying);
    let deepest = query.deepest().ok_or(2)?;
    is((deepest.penetration - 0.01).abs() < 0.002, 3)?;
    let wrench = query.wrench(torus.mass.center(), Weight::Area);
    is(
        wrench.force.z > 0.0 && wrench.force.truncate().length() < 0.2 * wrench.force.z,
        4,
    )?;
    let manifold = query.with_prediction(0.01).manifold::<4>();
    is(
        manifold.contacts().len() == 4 && manifold.contacts()[0] == deepest,
        5,
    )?;
    let work = Work::default();
    let mut segments = 0;
    query
        .observed_by(&work)
        .for_each_segment(3, |_, _| segments += 1);
    is(segments > 1 && work.points() > 0, 6)?;

    // Time-critical: stopped after 40 points, and complete.
    let some = query.time_critical(Vec3::ZERO, |tested| tested < 40);
    let all = query.time_critical(Vec3::ZERO, |_| true);
    is(
        !some.is_complete && some.penetration_bound >= deepest.penetration,
        7,
    )?;
    is(all.is_complete && all.deepest == Some(deepest), 8)?;

    // Above the ground, and falling onto it.
    let above = Pose3::from_translation(Vec3::new(0.0, 0.0, height + 0.51));
    let closest = Query::new(&torus.tree, &ground, above).closest().ok_or(9)?;
    is((closest.penetration + 0.5).abs() < 0.002, 10)?;
    let below = Pose3::from_translation(Vec3::new(0.0, 0.0, -3.0));
    let fall = Sweep::new(&torus.tree, &ground, above, below);
    let impact = fall.first_contact(1e-3).ok_or(11)?;
    is(
        (impact.shell_to_field.translation.z - height - 0.01).abs() < 0.005,
        12,
    )?;

    // Two tori that intersect.
    let turned = Pose3::from_translation(Vec3::new(0.4, 0.0, 0.05));
    let pair = BodyPair::new(Body::of_asset(&torus), Body::of_asset(&torus), turned);
    is(pair.with_shells(Shells::Both).touches(), 13)?;
    is(
        pair.wrench_on_first(Vec3::ZERO, Weight::Point)
            .force
            .length()
            > 0.0,
        14,
    )?;
    is(field.signed_distance(Vec3::ZERO) > 0.0, 15)?;

    // Pushed into the ground by a device, 5 mm deep.
    let tool = Tool::of(&torus.mass, 0.1);
    let options = CouplingOptions::critically_damped(&tool, 1000.0, 10.0);
    let at = |depth: f32| Pose3::from_translation(Vec3::new(0.0, 0.0, 0.1 + half_height - depth));
    let mut coupling = VirtualCoupling::new(tool, options, at(0.0)).map_err(|_| 16)?;
    for _ in 0..500 {
        let contact = Query::new(&torus.tree, &ground, coupling.pose())
            .linear_wrench(tool.center, Weight::Area);
        let contact = (contact * 1e9).rotated(coupling.pose().rotation);
        coupling.step(at(0.005), contact, 1e-3).map_err(|_| 17)?;
    }
    is((coupling.rendered().force.z - 5.0).abs() < 0.2, 18)
}

/// Entry point of the C start-up code.
#[unsafe(no_mangle)]
pub extern "C" fn main(_argc: i32, _argv: *const *const u8) -> i32 {
    check().err().unwrap_or(0)
}
