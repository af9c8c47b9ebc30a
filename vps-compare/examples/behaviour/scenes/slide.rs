use rapier3d::prelude::*;

use crate::models::{GEAR, GEAR_SCALE};
use crate::record::{Finding, Row};
use crate::setup::Setup;
use crate::stage::{Material, Stage};

pub(super) const SLIDES: &str = "\
A gear wheel lies on a slope of 20 degrees with a friction of 0.3. Between 0.5 s and 1.5 s it must
gain g (sin 20° − 0.3 cos 20°) = 0.590 m/s², to within 3 %.";

pub(super) const STICKS: &str = "\
The same with a friction of 0.5, which holds it: after 2 s it may drift by no more than 0.1 mm in a
second, and no part of it move at 1 mm/s or more.";

/// The slope in radians.
const SLOPE: f32 = 20.0 * std::f32::consts::PI / 180.0;

fn stage(setup: Setup, friction: f32) -> (Stage, RigidBodyHandle) {
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
    let gear = stage.add(&GEAR, RigidBodyBuilder::dynamic().pose(start));
    (stage, gear)
}

pub(super) fn slides(setup: Setup) -> Row {
    let (mut stage, gear) = stage(setup, 0.3);
    let down = Rotation::from_rotation_z(-SLOPE) * Vector::X;
    stage.go(0.5);
    let before = stage.body(gear).linvel().dot(down);
    stage.go(1.0);
    let gained = stage.body(gear).linvel().dot(down) - before;
    let expected = 9.81 * (SLOPE.sin() - 0.3 * SLOPE.cos());
    let off = 100.0 * f64::from(gained / expected - 1.0);
    let finding = Finding {
        what: "acceleration, off by %",
        value: stage.is_complete.then_some(off),
        digits: 2,
        is_good: off.abs() < 3.0,
    };
    Row::new("slide", &stage, None, finding)
}

pub(super) fn sticks(setup: Setup) -> Row {
    let (mut stage, _) = stage(setup, 0.5);
    stage.go(2.0);
    let rest = stage.watch(1.0);
    let finding = Finding {
        what: "drift in mm",
        value: rest.map(|r| f64::from(r.drift_m) * 1e3),
        digits: 3,
        is_good: rest.is_some_and(|r| r.drift_m < 1e-4 && r.speed_m_s < 1e-3),
    };
    Row::new("stick", &stage, rest, finding)
}
