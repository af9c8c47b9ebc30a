use rapier3d::prelude::*;

use super::upright;
use crate::models::{PEG, RING};
use crate::record::{Finding, Row};
use crate::setup::Setup;
use crate::stage::{PLAIN, Stage};

pub(super) const ABOUT: &str = "\
A ring with a hole of 0.2 m is thrown askew over a fixed peg of 0.12 m. When it lies on the foot it
is pushed aside at 2 m/s. Its centre must end no further from the peg's axis than the room of 40 mm,
and at rest to within 1 mm/s.";

pub(super) fn play(setup: Setup) -> Row {
    let mut stage = Stage::new(setup, 60.0, PLAIN);
    stage.add_ground();
    let peg = Pose::from_parts(Vector::Y * 0.3, upright());
    stage.add(&PEG, RigidBodyBuilder::fixed().pose(peg));
    let tilted = Rotation::from_rotation_z(0.3) * upright();
    let start = Pose::from_parts(Vector::new(-0.02, 0.72, 0.01), tilted);
    let thrown = RigidBodyBuilder::dynamic()
        .pose(start)
        .linvel(Vector::new(0.2, -0.5, 0.0))
        .angvel(Vector::Y);
    let ring = stage.add(&RING, thrown);
    stage.go(2.0);
    stage.world.bodies[ring].set_linvel(Vector::X * 2.0, true);
    stage.go(2.0);
    let rest = stage.watch(1.0);
    let center = stage.body(ring).translation();
    let aside = f64::from(Vector::new(center.x, 0.0, center.z).length());
    let finding = Finding {
        what: "centre off the peg's axis in mm",
        value: Some(1e3 * aside),
        digits: 1,
        is_good: aside < 0.041
            && (0.0..0.6).contains(&center.y)
            && rest.is_some_and(|r| r.speed_m_s < 1e-3),
    };
    Row::new("ring on a peg", &stage, rest, finding)
}
