//! Four gears, and four bunnies in a shaft, on each other.

use rapier3d::prelude::*;

use crate::experiments::behaviour::models::{GEAR_SCALE, ModelName};
use crate::experiments::behaviour::record::Record;
use crate::experiments::behaviour::setup::Setup;
use crate::experiments::behaviour::stage::{PLAIN, Stage};

pub(super) fn gears(setup: &Setup) -> Result<Record, String> {
    let mut stage = Stage::new(setup, 60.0, PLAIN);
    stage.add_ground();
    let thickness = 0.2 * GEAR_SCALE;
    let height = |i: u16| (f32::from(i) + 0.5) * thickness;
    for i in 0..4 {
        let turned = super::upright() * Rotation::from_rotation_z(0.13 * f32::from(i));
        let start = Pose::from_parts(Vector::new(0.0, height(i) + 0.002, 0.0), turned);
        stage.add(ModelName::Gear, RigidBodyBuilder::dynamic().pose(start))?;
    }
    stage.go(2.0);
    let rest = stage.watch(1.0);
    let top = stage
        .models()
        .last()
        .map(|(body, _)| body.center_of_mass().y);
    let off = top.map(|y| 1e3 * f64::from((y - height(3)).abs()));
    Ok(Record::of(&stage).with_rest(rest).with("top_off_mm", off))
}

pub(super) fn bunnies(setup: &Setup) -> Result<Record, String> {
    let mut stage = Stage::new(setup, 60.0, PLAIN).with_limit(20);
    stage.add_ground();
    for side in [-1.0, 1.0] {
        let aside = side * (0.16 + 0.05);
        stage.add_box([0.1, 3.0, 1.0], Pose::translation(aside, 1.5, 0.0));
        stage.add_box([1.0, 3.0, 0.1], Pose::translation(0.0, 1.5, aside));
    }
    for i in 0..4_u16 {
        let turned = Vector::Y * (1.3 * f32::from(i));
        let start = RigidBodyBuilder::dynamic()
            .translation(Vector::new(0.0, 0.2 + 0.3 * f32::from(i), 0.0))
            .rotation(turned);
        stage.add(ModelName::Bunny, start)?;
    }
    stage.go(5.0);
    let rest = stage.watch(1.0);
    Ok(Record::of(&stage).with_rest(rest))
}
