use rapier3d::prelude::*;

use crate::models::{BUNNY, GEAR, GEAR_SCALE};
use crate::record::{Finding, Row};
use crate::setup::Setup;
use crate::stage::{PLAIN, Stage};

pub(super) const GEARS: &str = "\
Four gear wheels of 60 mm lie on each other, each turned against the one below. After 2 s no part
may move at 1 mm/s or more, and the topmost must be at its height to within 4 mm.";

pub(super) const BUNNIES: &str = "\
Four bunnies fall on each other in a shaft 0.32 m wide. After 5 s no part may move at 5 mm/s or more,
and none may ever have been deeper than 10 mm in another.";

pub(super) fn gears(setup: Setup) -> Row {
    let mut stage = Stage::new(setup, 60.0, PLAIN);
    stage.add_ground();
    let thickness = 0.2 * GEAR_SCALE;
    let height = |i: u16| (f32::from(i) + 0.5) * thickness;
    for i in 0..4 {
        let turned = super::upright() * Rotation::from_rotation_z(0.13 * f32::from(i));
        let start = Pose::from_parts(Vector::new(0.0, height(i) + 0.002, 0.0), turned);
        stage.add(&GEAR, RigidBodyBuilder::dynamic().pose(start));
    }
    stage.go(2.0);
    let rest = stage.watch(1.0);
    let top = stage
        .models()
        .last()
        .map(|(body, _)| body.center_of_mass().y);
    let off = top.map(|y| 1e3 * f64::from((y - height(3)).abs()));
    let finding = Finding {
        what: "topmost off by mm",
        value: off,
        digits: 2,
        is_good: off.is_some_and(|o| o < 4.0) && rest.is_some_and(|r| r.speed_m_s < 1e-3),
    };
    Row::new("stack of gears", &stage, rest, finding)
}

pub(super) fn bunnies(setup: Setup) -> Row {
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
        stage.add(&BUNNY, start);
    }
    stage.go(5.0);
    let rest = stage.watch(1.0);
    let speed = rest.map(|r| 1e3 * f64::from(r.speed_m_s));
    let finding = Finding {
        what: "highest speed in mm/s",
        value: speed,
        digits: 3,
        is_good: speed.is_some_and(|s| s < 5.0) && stage.deepest_m < 0.01,
    };
    Row::new("stack of bunnies", &stage, rest, finding)
}
