use rapier3d::prelude::*;

use crate::models::{BALL, BALL_RADIUS};
use crate::record::{Finding, Row};
use crate::setup::Setup;
use crate::stage::{PLAIN, Stage};

pub(super) const SMOOTHLY: &str = "\
A ball of 5120 triangles rolls over a box at 1 m/s for 2 s. From step to step its spin may change by
no more than 2 %.";

pub(super) const ON: &str = "\
The same ball may lose no more than a tenth of its spin in the 2 s.";

/// Radians a second at which it rolls without sliding.
const SPIN: f32 = 1.0 / BALL_RADIUS;

/// The stage, the largest change of spin in a step and the spin at the end.
fn roll(setup: Setup) -> (Stage, f64, f64) {
    let mut stage = Stage::new(setup, 60.0, PLAIN);
    stage.add_ground();
    let start = RigidBodyBuilder::dynamic()
        .translation(Vector::new(-1.0, BALL_RADIUS, 0.0))
        .linvel(Vector::X)
        .angvel(-Vector::Z * SPIN);
    let ball = stage.add(&BALL, start);
    let mut last = stage.body(ball).angvel();
    let mut jump = 0.0_f32;
    stage.run(2.0, |stage| {
        let now = stage.body(ball).angvel();
        jump = jump.max((now - last).length());
        last = now;
        false
    });
    let share = |spin: f32| 100.0 * f64::from(spin / SPIN);
    (stage, share(jump), share(last.length()))
}

pub(super) fn smoothly(setup: Setup) -> Row {
    let (stage, jump, _) = roll(setup);
    let finding = Finding {
        what: "largest change of spin in a step, %",
        value: stage.is_complete.then_some(jump),
        digits: 2,
        is_good: jump < 2.0,
    };
    Row::new("roll smoothly", &stage, None, finding)
}

pub(super) fn on(setup: Setup) -> Row {
    let (stage, _, left) = roll(setup);
    let finding = Finding {
        what: "spin lost, %",
        value: stage.is_complete.then_some(100.0 - left),
        digits: 1,
        is_good: left > 90.0,
    };
    Row::new("roll on", &stage, None, finding)
}
