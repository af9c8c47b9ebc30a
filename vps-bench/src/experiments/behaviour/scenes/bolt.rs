//! A bolt 0.3 m long stands fixed, and its nut, without friction, screws itself down by its weight.

use std::f64::consts::TAU;

use rapier3d::prelude::*;
use vps_build::models::Thread;

use super::{Turned, upright};
use crate::experiments::behaviour::models::{ModelName, SCREW_SCALE};
use crate::experiments::behaviour::record::Record;
use crate::experiments::behaviour::setup::Setup;
use crate::experiments::behaviour::stage::{Material, Stage};

pub(super) fn play(setup: &Setup) -> Result<Record, String> {
    let material = Material {
        friction: 0.0,
        restitution: 0.0,
    };
    let mut stage = Stage::new(setup, 60.0, material).with_limit(30);
    let standing = Pose::from_parts(Vector::ZERO, upright());
    stage.add(ModelName::Bolt, RigidBodyBuilder::fixed().pose(standing))?;
    let pitch = Thread::default().pitch as f32 * SCREW_SCALE;
    // Two turns up, it fits as it is.
    let start = Pose::from_parts(Vector::Y * (2.0 * pitch), upright());
    let nut = stage.add(ModelName::Nut, RigidBodyBuilder::dynamic().pose(start))?;
    let mut turned = Turned::from(Rotation::IDENTITY);
    // Turns and height when the room between the threads is taken up.
    let mut from = None;
    stage.run(3.0, |stage| {
        let position = stage.body(nut).position();
        turned.follow(upright().inverse() * position.rotation);
        if from.is_none() && turned.total < -0.25 * TAU {
            from = Some((turned.total, position.translation.y));
        }
        position.translation.y < -pitch
    });
    let end = stage.body(nut).translation().y;
    let off = from.map(|(angle, height)| {
        let turns = (angle - turned.total) / TAU;
        100.0 * (f64::from((height - end) / pitch) / turns - 1.0)
    });
    let record = Record::of(&stage)
        .with("pitch_off_percent", off)
        .with("turns", -turned.total / TAU);
    Ok(record)
}
