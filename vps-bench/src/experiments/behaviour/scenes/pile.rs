//! A hundred bunnies fall into a bin. Triangle meshes start from where VPS left them.

use rapier3d::prelude::*;

use crate::experiments::behaviour::collider::Collider;
use crate::experiments::behaviour::models::ModelName;
use crate::experiments::behaviour::patience::patiently;
use crate::experiments::behaviour::record::Record;
use crate::experiments::behaviour::setup::Setup;
use crate::experiments::behaviour::stage::{PLAIN, Rest, Stage};

/// Bunnies.
const COUNT: u16 = 100;
/// Inner width of the bin in metres.
const WIDTH: f32 = 1.3;

pub(super) fn play(setup: &Setup) -> Result<Record, String> {
    if setup.collider != Collider::Trimesh {
        let settled = settle(setup)?;
        return Ok(settled.record());
    }
    let by_vps = Setup {
        collider: Collider::Vps,
        ..setup.clone()
    };
    let settled = settle(&by_vps)?;
    let bodies = settled.stage.models();
    let poses: Vec<_> = bodies.map(|(body, _)| *body.position()).collect();
    setup.model(ModelName::Bunny)?.shape(setup.collider)?;
    let setup = setup.clone();
    patiently(move || one_step(&setup, &poses))
}

fn bin<'s>(setup: &'s Setup, poses: &[Pose]) -> Result<Stage<'s>, String> {
    let mut stage = Stage::new(setup, 60.0, PLAIN).with_limit(60);
    stage.add_ground();
    for side in [-1.0, 1.0] {
        let aside = side * (0.5 * WIDTH + 0.1);
        stage.add_box([0.2, 4.0, 2.0], Pose::translation(aside, 2.0, 0.0));
        stage.add_box([2.0, 4.0, 0.2], Pose::translation(0.0, 2.0, aside));
    }
    for &pose in poses {
        stage.add(ModelName::Bunny, RigidBodyBuilder::dynamic().pose(pose))?;
    }
    Ok(stage)
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

/// The pile after 5 s in which to settle, and one more.
struct Settled<'s> {
    stage: Stage<'s>,
    rest: Option<Rest>,
    /// Of the last second alone.
    steps_per_s: f64,
}

fn settle(setup: &Setup) -> Result<Settled<'_>, String> {
    let mut stage = bin(setup, &start())?;
    stage.go(5.0);
    let (steps, seconds) = (stage.steps, stage.stepping_s());
    let rest = stage.watch(1.0);
    let steps_per_s = f64::from(stage.steps - steps) / (stage.stepping_s() - seconds);
    Ok(Settled {
        stage,
        rest,
        steps_per_s,
    })
}

impl Settled<'_> {
    fn record(&self) -> Record {
        let is_outside = |body: &RigidBody| {
            let center = body.center_of_mass();
            center.x.abs().max(center.z.abs()) >= 0.5 * WIDTH || center.y <= 0.0
        };
        let outside = self.stage.models().filter(|(body, _)| is_outside(body));
        let steps_per_s = self.rest.map(|_| self.steps_per_s);
        Record::of(&self.stage)
            .with_rest(self.rest)
            .with("settled_steps_per_s", steps_per_s)
            .with("outside", outside.count() as f64)
    }
}

/// One step of triangle meshes, which is not the whole scene.
fn one_step(setup: &Setup, poses: &[Pose]) -> Result<Record, String> {
    let mut stage = bin(setup, poses)?;
    stage.go(1.0 / 60.0);
    stage.is_complete = false;
    let steps_per_s = stage.steps_per_s();
    Ok(Record::of(&stage).with("settled_steps_per_s", steps_per_s))
}
