//! A motor turns a gear of 16 teeth at 3 rad/s, which drives one of 12 on a braking axle.

use std::f32::consts::{PI, TAU};

use rapier3d::prelude::*;

use super::Turned;
use crate::experiments::behaviour::models::{GEAR_SCALE, ModelName};
use crate::experiments::behaviour::record::Record;
use crate::experiments::behaviour::setup::Setup;
use crate::experiments::behaviour::stage::{Material, Stage};

pub(super) fn play(setup: &Setup) -> Result<Record, String> {
    let material = Material {
        friction: 0.2,
        restitution: 0.0,
    };
    let mut stage = Stage::new(setup, 60.0, material);
    // Tips of the large one reach 3 mm short of the roots of the small one.
    let distance = (0.5 + 0.38 * 12.0 / 16.0 + 0.01) * GEAR_SCALE;
    // The middle of a tooth faces the middle of a gap.
    let tooth_to_x = Rotation::from_rotation_z(-0.25 * TAU / 16.0);
    let gap_to_minus_x = Rotation::from_rotation_z(PI - 0.75 * TAU / 12.0);
    let driving = stage.add(
        ModelName::Gear,
        RigidBodyBuilder::dynamic().pose(Pose::from_parts(Vector::ZERO, tooth_to_x)),
    )?;
    let driven = stage.add(
        ModelName::SmallGear,
        RigidBodyBuilder::dynamic()
            .pose(Pose::from_parts(Vector::X * distance, gap_to_minus_x))
            .angular_damping(1.0),
    )?;
    let axles = stage.world.insert_body(RigidBodyBuilder::fixed());
    let axle = |x: f32| RevoluteJointBuilder::new(Vector::Z).local_anchor1(Vector::X * x);
    let motor = axle(0.0).motor_velocity(3.0, 1e3);
    stage.world.insert_impulse_joint(axles, driving, motor);
    stage
        .world
        .insert_impulse_joint(axles, driven, axle(distance));
    let rotation = |stage: &Stage<'_>, gear| stage.body(gear).position().rotation;
    // Until the teeth touch.
    stage.go(0.5);
    let [mut first, mut second] =
        [driving, driven].map(|gear| Turned::from(rotation(&stage, gear)));
    let is_complete = stage.run(5.0, |stage| {
        first.follow(rotation(stage, driving));
        second.follow(rotation(stage, driven));
        false
    });
    let ratio = -second.total / first.total;
    let off = 100.0 * (ratio * 12.0 / 16.0 - 1.0);
    let record = Record::of(&stage)
        .with("ratio_off_percent", is_complete.then_some(off))
        .with("turned_rad", first.total);
    Ok(record)
}
