//! A bunny falls 50 mm on a plate 2 mm thick that lies on two bars.

use rapier3d::prelude::*;

use crate::experiments::behaviour::models::{ModelName, PLATE_THICKNESS};
use crate::experiments::behaviour::record::Record;
use crate::experiments::behaviour::setup::Setup;
use crate::experiments::behaviour::stage::{PLAIN, Stage};

pub(super) fn play(setup: &Setup) -> Result<Record, String> {
    let mut stage = Stage::new(setup, 60.0, PLAIN);
    for side in [-1.0, 1.0] {
        stage.add_box([0.1, 0.2, 0.6], Pose::translation(0.2 * side, -0.1, 0.0));
    }
    let lying = Vector::Y * (0.5 * PLATE_THICKNESS);
    let plate = stage.add(
        ModelName::Plate,
        RigidBodyBuilder::dynamic().translation(lying),
    )?;
    let low = setup.model(ModelName::Bunny)?.asset.voxelmap.solid().min.y;
    let above = Vector::Y * (0.05 + PLATE_THICKNESS - low);
    let bunny = stage.add(
        ModelName::Bunny,
        RigidBodyBuilder::dynamic().translation(above),
    )?;
    stage.go(3.0);
    let rest = stage.watch(1.0);
    let plate_off = stage.body(plate).translation().distance(lying);
    let height = stage.body(bunny).center_of_mass().y;
    let record = Record::of(&stage)
        .with_rest(rest)
        .with("bunny_height_m", f64::from(height))
        .with("plate_off_mm", 1e3 * f64::from(plate_off));
    Ok(record)
}
