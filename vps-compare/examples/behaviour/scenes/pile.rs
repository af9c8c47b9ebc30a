use std::sync::OnceLock;

use rapier3d::prelude::*;

use crate::models::{BUNNY, Kind};
use crate::record::{Finding, Row};
use crate::setup::Setup;
use crate::stage::{PLAIN, Stage};

pub(super) const ABOUT: &str = "\
A hundred bunnies fall into a bin 1.3 m wide and have 5 s to settle. In the second after there must be
60 steps a second or more, all bunnies in the bin, and at its end none 20 mm deep in another or in
the bin. The triangle mesh starts from where VPS left them.";

const WHAT: &str = "steps a second when settled";

/// Bunnies.
const COUNT: u16 = 100;
/// Inner width of the bin in metres.
const WIDTH: f32 = 1.3;

/// Where the bunnies are that collide as VPS when they have settled.
static SETTLED: OnceLock<Vec<Pose>> = OnceLock::new();

pub(super) fn play(setup: Setup) -> Row {
    match setup.kind {
        Kind::Trimesh => one_step(setup),
        _ => settle(setup),
    }
}

fn bin(setup: Setup, poses: &[Pose]) -> Stage {
    let mut stage = Stage::new(setup, 60.0, PLAIN).with_limit(60);
    stage.add_ground();
    for side in [-1.0, 1.0] {
        let aside = side * (0.5 * WIDTH + 0.1);
        stage.add_box([0.2, 4.0, 2.0], Pose::translation(aside, 2.0, 0.0));
        stage.add_box([2.0, 4.0, 0.2], Pose::translation(0.0, 2.0, aside));
    }
    for &pose in poses {
        stage.add(&BUNNY, RigidBodyBuilder::dynamic().pose(pose));
    }
    stage
}

/// Four by four bunnies a layer, each turned in its own way.
fn start() -> Vec<Pose> {
    let pose = |i: u16| {
        let [x, y, z] = [i % 4, i / 16, i / 4 % 4].map(f32::from);
        let place = Vector::new(0.31 * (x - 1.5), 0.25 + 0.33 * y, 0.31 * (z - 1.5));
        let n = f32::from(i);
        let turned = Vector::new(2.4 * n, 1.1 * n, 0.7 * n);
        let turned = Vector::new(turned.x.sin(), turned.y.sin(), turned.z.sin()) * 3.0;
        Pose::from_parts(place, Rotation::from_scaled_axis(turned))
    };
    (0..COUNT).map(pose).collect()
}

fn settle(setup: Setup) -> Row {
    let mut stage = bin(setup, &start());
    stage.go(5.0);
    let (steps, seconds) = (stage.steps, stage.stepping_s());
    let rest = stage.watch(1.0);
    let steps_per_s = f64::from(stage.steps - steps) / (stage.stepping_s() - seconds);
    if setup.kind == Kind::Vps {
        let poses = stage.models().map(|(body, _)| *body.position());
        let _ = SETTLED.set(poses.collect());
    }
    let is_inside = stage.models().all(|(body, _)| {
        let center = body.center_of_mass().abs();
        center.x.max(center.z) < 0.5 * WIDTH && body.center_of_mass().y > 0.0
    });
    let finding = Finding {
        what: WHAT,
        value: rest.map(|_| steps_per_s),
        digits: 1,
        is_good: steps_per_s >= 60.0 && is_inside && rest.is_some_and(|r| r.deepest_m < 0.02),
    };
    Row::new("pile", &stage, rest, finding)
}

/// Of triangle meshes, from where all have settled.
fn one_step(setup: Setup) -> Row {
    let poses = SETTLED.get().cloned().unwrap_or_else(start);
    let mut stage = bin(setup, &poses);
    stage.go(1.0 / 60.0);
    stage.is_complete = false;
    let finding = Finding {
        what: WHAT,
        value: Some(stage.steps_per_s()),
        digits: 4,
        is_good: false,
    };
    Row::new("pile", &stage, None, finding)
}
