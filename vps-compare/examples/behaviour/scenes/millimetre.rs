use rapier3d::prelude::*;

use crate::models::SMALL_BUNNY;
use crate::record::{Finding, Row};
use crate::setup::Setup;
use crate::stage::{PLAIN, Stage};

pub(super) const ABOUT: &str = "\
The first scene with a bunny 2 mm wide that falls from 2.2 mm; the engine is told that lengths are so
much smaller and makes 700 steps a second. It has 0.5 s; in the 0.2 s after no part of it may move at
1 mm/s or more, and none may ever have been 0.1 mm deep.";

/// Of the bunny in the other scenes.
const TIMES_SMALLER: f32 = 135.0;

pub(super) fn play(setup: Setup) -> Row {
    let mut stage = Stage::new(setup, 700.0, PLAIN);
    stage.world.integration_parameters.length_unit = 1.0 / TIMES_SMALLER;
    stage.add_box([0.03, 0.002, 0.03], Pose::translation(0.0, -0.001, 0.0));
    let start = RigidBodyBuilder::dynamic()
        .translation(Vector::new(0.0, 0.3 / TIMES_SMALLER, 0.0))
        .rotation(Vector::new(0.4, 0.7, 0.2));
    stage.add(&SMALL_BUNNY, start);
    stage.go(0.5);
    let rest = stage.watch(0.2);
    let speed = rest.map(|r| f64::from(r.speed_m_s) * 1e3);
    let finding = Finding {
        what: "highest speed in mm/s",
        value: speed,
        digits: 3,
        is_good: speed.is_some_and(|s| s < 1.0) && stage.deepest_m < 1e-4,
    };
    Row::new("millimetres", &stage, rest, finding)
}
