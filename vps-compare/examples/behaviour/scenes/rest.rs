use rapier3d::prelude::*;

use crate::models::BUNNY;
use crate::record::{Finding, Row};
use crate::setup::Setup;
use crate::stage::{PLAIN, Stage};

pub(super) const ABOUT: &str = "\
A bunny falls askew from 0.3 m on a box and has 4 s to come to rest. In the second after no part of
it may move at 1 mm/s or more.";

pub(super) fn play(setup: Setup) -> Row {
    let mut stage = Stage::new(setup, 60.0, PLAIN);
    stage.add_ground();
    let start = RigidBodyBuilder::dynamic()
        .translation(Vector::new(0.0, 0.3, 0.0))
        .rotation(Vector::new(0.4, 0.7, 0.2));
    stage.add(&BUNNY, start);
    stage.go(4.0);
    let rest = stage.watch(1.0);
    let speed = rest.map(|r| f64::from(r.speed_m_s) * 1e3);
    let finding = Finding {
        what: "highest speed in mm/s",
        value: speed,
        digits: 3,
        is_good: speed.is_some_and(|s| s < 1.0),
    };
    Row::new("rest", &stage, rest, finding)
}
