//! Without gravity, a bunny starts 50 mm beside another one, and so inside of it.

use rapier3d::prelude::*;

use crate::experiments::behaviour::collider::Collider;
use crate::experiments::behaviour::models::ModelName;
use crate::experiments::behaviour::patience::patiently;
use crate::experiments::behaviour::record::Record;
use crate::experiments::behaviour::setup::Setup;
use crate::experiments::behaviour::stage::{PLAIN, Stage};

pub(super) fn play(setup: &Setup) -> Result<Record, String> {
    if setup.collider == Collider::Trimesh {
        // Making the shape does not count.
        setup.model(ModelName::Bunny)?.shape(setup.collider)?;
        let setup = setup.clone();
        return patiently(move || separate(&setup));
    }
    separate(setup)
}

fn separate(setup: &Setup) -> Result<Record, String> {
    let mut stage = Stage::new(setup, 60.0, PLAIN);
    stage.world.gravity = Vector::ZERO;
    stage.add(ModelName::Bunny, RigidBodyBuilder::dynamic())?;
    let aside = Vector::new(0.04, 0.02, 0.02);
    let beside = RigidBodyBuilder::dynamic().translation(aside);
    stage.add(ModelName::Bunny, beside)?;
    stage.deepest_m = stage.depth();
    let (mut fastest, mut is_apart) = (0.0_f32, false);
    stage.run(2.0, |stage| {
        fastest = fastest.max(stage.speed());
        is_apart = stage.depth() < stage.world.integration_parameters.allowed_linear_error();
        is_apart
    });
    let seconds = f64::from(stage.steps) / f64::from(stage.frequency_hz());
    let record = Record::of(&stage)
        .with("apart_after_s", is_apart.then_some(seconds))
        .with("top_speed_m_s", f64::from(fastest));
    Ok(record)
}
