//! A bunny falls askew from 0.3 m on a box.

use rapier3d::prelude::*;

use crate::experiments::behaviour::models::ModelName;
use crate::experiments::behaviour::record::Record;
use crate::experiments::behaviour::setup::Setup;
use crate::experiments::behaviour::stage::{PLAIN, Stage};

pub(super) fn play(setup: &Setup) -> Result<Record, String> {
    let mut stage = Stage::new(setup, 60.0, PLAIN);
    stage.add_ground();
    let start = RigidBodyBuilder::dynamic()
        .translation(Vector::new(0.0, 0.3, 0.0))
        .rotation(Vector::new(0.4, 0.7, 0.2));
    stage.add(ModelName::Bunny, start)?;
    stage.go(4.0);
    let rest = stage.watch(1.0);
    Ok(Record::of(&stage).with_rest(rest))
}
