//! A ball of 5120 triangles falls 0.5 m on a box with a restitution of 0.5, at 200 Hz.

use rapier3d::prelude::*;

use crate::experiments::behaviour::models::{BALL_RADIUS, ModelName};
use crate::experiments::behaviour::record::Record;
use crate::experiments::behaviour::setup::Setup;
use crate::experiments::behaviour::stage::{Material, Stage};

pub(super) fn play(setup: &Setup) -> Result<Record, String> {
    let material = Material {
        friction: 0.5,
        restitution: 0.5,
    };
    let mut stage = Stage::new(setup, 200.0, material);
    stage.add_ground();
    let fall = 0.5;
    let start = Vector::new(0.0, BALL_RADIUS + fall, 0.0);
    let ball = stage.add(
        ModelName::Ball,
        RigidBodyBuilder::dynamic().translation(start),
    )?;
    let (mut bounced, mut highest) = (false, 0.0_f32);
    stage.run(1.5, |stage| {
        let ball = stage.body(ball);
        bounced |= ball.linvel().y > 0.0;
        if bounced {
            highest = highest.max(ball.translation().y - BALL_RADIUS);
        }
        bounced && ball.linvel().y < 0.0
    });
    let ratio = bounced.then(|| f64::from(highest / fall));
    Ok(Record::of(&stage).with("height_ratio", ratio))
}
