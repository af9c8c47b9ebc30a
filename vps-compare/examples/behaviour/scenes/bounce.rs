use rapier3d::prelude::*;

use crate::models::{BALL, BALL_RADIUS};
use crate::record::{Finding, Row};
use crate::setup::Setup;
use crate::stage::{Material, Stage};

pub(super) const ABOUT: &str = "\
A ball of 5120 triangles falls 0.5 m on a box with a restitution of 0.5. It must come up again to a
quarter of that height, to within 10 %. 200 steps a second.";

pub(super) fn play(setup: Setup) -> Row {
    let material = Material {
        friction: 0.5,
        restitution: 0.5,
    };
    let mut stage = Stage::new(setup, 200.0, material);
    stage.add_ground();
    let fall = 0.5;
    let start = Vector::new(0.0, BALL_RADIUS + fall, 0.0);
    let ball = stage.add(&BALL, RigidBodyBuilder::dynamic().translation(start));
    let (mut bounced, mut highest) = (false, 0.0_f32);
    stage.run(1.5, |stage| {
        let ball = stage.body(ball);
        bounced |= ball.linvel().y > 0.0;
        if bounced {
            highest = highest.max(ball.translation().y - BALL_RADIUS);
        }
        bounced && ball.linvel().y < 0.0
    });
    let ratio = f64::from(highest / fall);
    let finding = Finding {
        what: "height after / before",
        value: bounced.then_some(ratio),
        digits: 3,
        is_good: (ratio / 0.25 - 1.0).abs() < 0.1,
    };
    Row::new("bounce", &stage, None, finding)
}
