use rapier3d::prelude::*;

use crate::models::{BUNNY, PLATE, PLATE_THICKNESS};
use crate::record::{Finding, Row};
use crate::setup::Setup;
use crate::stage::{PLAIN, Stage};

pub(super) const ABOUT: &str = "\
A bunny falls 50 mm on a plate 2 mm thick that lies on two bars. After 3 s both must be at rest to
within 1 mm/s, with the bunny on the plate, the plate on the bars, and nothing ever deeper than 2 mm.";

pub(super) fn play(setup: Setup) -> Row {
    let mut stage = Stage::new(setup, 60.0, PLAIN);
    for side in [-1.0, 1.0] {
        stage.add_box([0.1, 0.2, 0.6], Pose::translation(0.2 * side, -0.1, 0.0));
    }
    let lying = Vector::Y * (0.5 * PLATE_THICKNESS);
    let plate = stage.add(&PLATE, RigidBodyBuilder::dynamic().translation(lying));
    let low = BUNNY.asset.voxelmap.solid().min.y;
    let above = Vector::Y * (0.05 + PLATE_THICKNESS - low);
    let bunny = stage.add(&BUNNY, RigidBodyBuilder::dynamic().translation(above));
    stage.go(3.0);
    let rest = stage.watch(1.0);
    let plate_off = stage.body(plate).translation().distance(lying);
    let is_on = stage.body(bunny).center_of_mass().y > 0.0 && plate_off < 0.02;
    let deepest = f64::from(stage.deepest_m);
    let finding = Finding {
        what: "deepest in mm",
        value: Some(1e3 * deepest),
        digits: 2,
        is_good: is_on && deepest < 0.002 && rest.is_some_and(|r| r.speed_m_s < 1e-3),
    };
    Row::new("thin plate", &stage, rest, finding)
}
