use std::f32::consts::FRAC_PI_2;

use rapier3d::prelude::*;

use crate::models::{LINK, LINK_SCALE};
use crate::record::{Finding, Row};
use crate::setup::Setup;
use crate::stage::{PLAIN, Stage};

pub(super) const ABOUT: &str = "\
Six links 0.2 m long hang from each other, the topmost fixed; the lowest starts at 1 m/s to the side.
In 5 s the centres of neighbours, 144 mm apart, may never get further apart by 14 mm or more, half
of the rod.";

/// Links.
const COUNT: u16 = 6;

pub(super) fn play(setup: Setup) -> Row {
    let mut stage = Stage::new(setup, 60.0, PLAIN);
    let apart = 0.72 * LINK_SCALE;
    let links: Vec<_> = (0..COUNT)
        .map(|i| {
            let turned = Rotation::from_rotation_y(FRAC_PI_2 * f32::from(i % 2))
                * Rotation::from_rotation_z(FRAC_PI_2);
            let start = Vector::Y * (-0.99 * apart * f32::from(i));
            let body = match i {
                0 => RigidBodyBuilder::fixed(),
                _ => RigidBodyBuilder::dynamic(),
            };
            let pushed = if i == COUNT - 1 { 1.0 } else { 0.0 };
            let body = body
                .pose(Pose::from_parts(start, turned))
                .linvel(Vector::X * pushed);
            stage.add(&LINK, body)
        })
        .collect();
    let mut longest = 0.0_f32;
    let mut follow = |stage: &Stage| {
        for pair in links.windows(2) {
            let [a, b] = [pair[0], pair[1]].map(|l| stage.body(l).translation());
            longest = longest.max(a.distance(b));
        }
        false
    };
    stage.run(5.0, &mut follow);
    let stretch = f64::from(longest - apart);
    let finding = Finding {
        what: "furthest too far apart in mm",
        value: Some(1e3 * stretch),
        digits: 2,
        is_good: stretch < 0.014,
    };
    Row::new("chain", &stage, None, finding)
}
