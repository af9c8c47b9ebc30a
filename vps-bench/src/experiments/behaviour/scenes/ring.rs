//! A ring is thrown askew over a fixed peg, and pushed aside at 2 m/s once it lies on the foot.

use rapier3d::prelude::*;

use super::upright;
use crate::experiments::behaviour::models::ModelName;
use crate::experiments::behaviour::record::Record;
use crate::experiments::behaviour::setup::Setup;
use crate::experiments::behaviour::stage::{PLAIN, Stage};

pub(super) fn play(setup: &Setup) -> Result<Record, String> {
    let mut stage = Stage::new(setup, 60.0, PLAIN);
    stage.add_ground();
    let peg = Pose::from_parts(Vector::Y * 0.3, upright());
    stage.add(ModelName::Peg, RigidBodyBuilder::fixed().pose(peg))?;
    let tilted = Rotation::from_rotation_z(0.3) * upright();
    let start = Pose::from_parts(Vector::new(-0.02, 0.72, 0.01), tilted);
    let thrown = RigidBodyBuilder::dynamic()
        .pose(start)
        .linvel(Vector::new(0.2, -0.5, 0.0))
        .angvel(Vector::Y);
    let ring = stage.add(ModelName::Ring, thrown)?;
    stage.go(2.0);
    stage.world.bodies[ring].set_linvel(Vector::X * 2.0, true);
    stage.go(2.0);
    let rest = stage.watch(1.0);
    let center = stage.body(ring).translation();
    let aside = f64::from(Vector::new(center.x, 0.0, center.z).length());
    let record = Record::of(&stage)
        .with_rest(rest)
        .with("off_axis_mm", 1e3 * aside)
        .with("height_m", f64::from(center.y));
    Ok(record)
}
