//! Six links 0.2 m long hang from each other, the topmost fixed; the lowest starts at 1 m/s to the
//! side.

use std::f32::consts::FRAC_PI_2;

use rapier3d::prelude::*;

use crate::experiments::behaviour::models::{LINK_SCALE, ModelName};
use crate::experiments::behaviour::record::Record;
use crate::experiments::behaviour::setup::Setup;
use crate::experiments::behaviour::stage::{PLAIN, Stage};

/// Links.
const COUNT: u16 = 6;

pub(super) fn play(setup: &Setup) -> Result<Record, String> {
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
            stage.add(ModelName::Link, body)
        })
        .collect::<Result<_, _>>()?;
    let mut longest = 0.0_f32;
    let mut follow = |stage: &Stage<'_>| {
        for pair in links.windows(2) {
            let [a, b] = [pair[0], pair[1]].map(|l| stage.body(l).translation());
            longest = longest.max(a.distance(b));
        }
        false
    };
    stage.run(5.0, &mut follow);
    let stretch = 1e3 * f64::from(longest - apart);
    Ok(Record::of(&stage).with("stretch_mm", stretch))
}
