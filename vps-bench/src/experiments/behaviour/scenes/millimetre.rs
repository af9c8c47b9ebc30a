//! The first scene with a bunny 2 mm wide that falls from 2.2 mm, at 700 Hz; the engine is told that
//! lengths are that much smaller.

use rapier3d::prelude::*;

use crate::experiments::behaviour::models::{ModelName, TIMES_SMALLER};
use crate::experiments::behaviour::record::Record;
use crate::experiments::behaviour::setup::Setup;
use crate::experiments::behaviour::stage::{PLAIN, Stage};

pub(super) fn play(setup: &Setup) -> Result<Record, String> {
    let mut stage = Stage::new(setup, 700.0, PLAIN);
    stage.world.integration_parameters.length_unit = 1.0 / TIMES_SMALLER;
    stage.add_box([0.03, 0.002, 0.03], Pose::translation(0.0, -0.001, 0.0));
    let start = RigidBodyBuilder::dynamic()
        .translation(Vector::new(0.0, 0.3 / TIMES_SMALLER, 0.0))
        .rotation(Vector::new(0.4, 0.7, 0.2));
    stage.add(ModelName::SmallBunny, start)?;
    stage.go(0.5);
    let rest = stage.watch(0.2);
    Ok(Record::of(&stage).with_rest(rest))
}
