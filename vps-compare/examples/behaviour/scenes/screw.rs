use std::f64::consts::TAU;

use rapier3d::prelude::*;
use vps_build::models::Thread;

use super::{Turned, upright};
use crate::models::{BOLT, NUT, SCREW_SCALE};
use crate::record::{Finding, Row};
use crate::setup::Setup;
use crate::stage::{Material, Stage};

pub(super) const ABOUT: &str = "\
A bolt 0.3 m long stands fixed, and its nut, without friction, screws itself down by its weight:
2.4 mm of room, three turns at most. It must turn more than once and, after the first quarter, go
down by the pitch of 45 mm a turn, to within 3 %.";

pub(super) fn play(setup: Setup) -> Row {
    let material = Material {
        friction: 0.0,
        restitution: 0.0,
    };
    let mut stage = Stage::new(setup, 60.0, material).with_limit(30);
    let standing = Pose::from_parts(Vector::ZERO, upright());
    stage.add(&BOLT, RigidBodyBuilder::fixed().pose(standing));
    let pitch = Thread::default().pitch as f32 * SCREW_SCALE;
    // Two turns up, it fits as it is.
    let start = Pose::from_parts(Vector::Y * (2.0 * pitch), upright());
    let nut = stage.add(&NUT, RigidBodyBuilder::dynamic().pose(start));
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
    let finding = Finding {
        what: "way a turn, off by %",
        value: off,
        digits: 2,
        is_good: off.is_some_and(|o| o.abs() < 3.0) && turned.total < -TAU,
    };
    Row::new("bolt in nut", &stage, None, finding)
}
