//! A ball of 5120 triangles rolls over a box at 1 m/s for 2 s.

use rapier3d::prelude::*;

use crate::experiments::behaviour::models::{BALL_RADIUS, ModelName};
use crate::experiments::behaviour::record::Record;
use crate::experiments::behaviour::setup::Setup;
use crate::experiments::behaviour::stage::{PLAIN, Stage};

/// Radians a second at which it rolls without sliding.
const SPIN: f32 = 1.0 / BALL_RADIUS;

pub(super) fn play(setup: &Setup) -> Result<Record, String> {
    let mut stage = Stage::new(setup, 60.0, PLAIN);
    stage.add_ground();
    let start = RigidBodyBuilder::dynamic()
        .translation(Vector::new(-1.0, BALL_RADIUS, 0.0))
        .linvel(Vector::X)
        .angvel(-Vector::Z * SPIN);
    let ball = stage.add(ModelName::Ball, start)?;
    let mut last = stage.body(ball).angvel();
    let mut jump = 0.0_f32;
    let is_complete = stage.run(2.0, |stage| {
        let now = stage.body(ball).angvel();
        jump = jump.max((now - last).length());
        last = now;
        false
    });
    let percent = |spin: f32| is_complete.then(|| 100.0 * f64::from(spin / SPIN));
    let lost = percent(last.length()).map(|left| 100.0 - left);
    let record = Record::of(&stage)
        .with("spin_step_percent", percent(jump))
        .with("spin_lost_percent", lost);
    Ok(record)
}
