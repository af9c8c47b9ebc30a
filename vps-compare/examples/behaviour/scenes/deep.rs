use rapier3d::prelude::*;

use crate::models::BUNNY;
use crate::record::{Finding, Row};
use crate::setup::Setup;
use crate::stage::{PLAIN, Stage};

pub(super) const ABOUT: &str = "\
Without gravity, a bunny starts 50 mm aside of another one and so inside of it. They must be out
of each other in less than a second, but for the 5 mm that rapier lets bodies rest in each other, and
never be faster than 5 m/s.";

pub(super) fn play(setup: Setup) -> Row {
    let mut stage = Stage::new(setup, 60.0, PLAIN);
    stage.world.gravity = Vector::ZERO;
    stage.add(&BUNNY, RigidBodyBuilder::dynamic());
    let aside = Vector::new(0.04, 0.02, 0.02);
    stage.add(&BUNNY, RigidBodyBuilder::dynamic().translation(aside));
    stage.deepest_m = stage.depth();
    let (mut fastest, mut is_apart) = (0.0_f32, false);
    stage.run(2.0, |stage| {
        fastest = fastest.max(stage.speed());
        is_apart = stage.depth() < stage.world.integration_parameters.allowed_linear_error();
        is_apart
    });
    let seconds = f64::from(stage.steps) / f64::from(stage.frequency_hz());
    let finding = Finding {
        what: "out after s",
        value: is_apart.then_some(seconds),
        digits: 2,
        is_good: is_apart && seconds < 1.0 && fastest < 5.0,
    };
    Row::new("deep inside", &stage, None, finding)
}
