//! A gear lies on a slope of 20 degrees: with a friction of 0.3 it slides, with 0.5 it sticks.

use rapier3d::prelude::*;

use crate::experiments::behaviour::models::{GEAR_SCALE, ModelName};
use crate::experiments::behaviour::record::Record;
use crate::experiments::behaviour::setup::Setup;
use crate::experiments::behaviour::stage::{Material, Stage};

/// The slope in radians.
const SLOPE: f32 = 20.0 * std::f32::consts::PI / 180.0;

fn stage(setup: &Setup, friction: f32) -> Result<(Stage<'_>, RigidBodyHandle), String> {
    let material = Material {
        friction,
        restitution: 0.0,
    };
    let mut stage = Stage::new(setup, 60.0, material);
    let slope = Rotation::from_rotation_z(-SLOPE);
    stage.add_box(
        [6.0, 0.2, 2.0],
        Pose::from_parts(slope * Vector::new(0.0, -0.1, 0.0), slope),
    );
    let above = Vector::new(-1.0, 0.1 * GEAR_SCALE, 0.0);
    let start = Pose::from_parts(slope * above, slope * super::upright());
    let gear = stage.add(ModelName::Gear, RigidBodyBuilder::dynamic().pose(start))?;
    Ok((stage, gear))
}

pub(super) fn slides(setup: &Setup) -> Result<Record, String> {
    let (mut stage, gear) = stage(setup, 0.3)?;
    let down = Rotation::from_rotation_z(-SLOPE) * Vector::X;
    stage.go(0.5);
    let before = stage.body(gear).linvel().dot(down);
    stage.go(1.0);
    let gained = stage.body(gear).linvel().dot(down) - before;
    let expected = 9.81 * (SLOPE.sin() - 0.3 * SLOPE.cos());
    let off = 100.0 * f64::from(gained / expected - 1.0);
    let off = stage.is_complete.then_some(off);
    Ok(Record::of(&stage).with("acceleration_off_percent", off))
}

pub(super) fn sticks(setup: &Setup) -> Result<Record, String> {
    let (mut stage, _) = stage(setup, 0.5)?;
    stage.go(2.0);
    let rest = stage.watch(1.0);
    Ok(Record::of(&stage).with_rest(rest))
}
