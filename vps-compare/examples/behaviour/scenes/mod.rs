//! The scenes, one a file.

mod bounce;
mod chain;
mod deep;
mod gears;
mod millimetre;
mod pile;
mod rest;
mod ring;
mod roll;
mod screw;
mod slide;
mod stack;
mod thin;

use rapier3d::prelude::*;

use crate::models::{ALL_KINDS, BUNNY_KINDS, KINDS, KINDS_AND_SEGMENTS, Kind};
use crate::record::Row;
use crate::setup::Setup;

/// Scenes in which triangle meshes may take longer than anyone waits for a step.
pub(crate) const ENDLESS: [&str; 2] = ["deep inside", "pile"];

/// Something that should happen.
pub(crate) struct Scene {
    pub(crate) name: &'static str,
    /// What happens, and when it is as it should be.
    pub(crate) about: &'static str,
    pub(crate) kinds: &'static [Kind],
    pub(crate) play: fn(Setup) -> Row,
}

/// All scenes.
pub(crate) const SCENES: [Scene; 16] = [
    Scene {
        name: "rest",
        about: rest::ABOUT,
        kinds: &ALL_KINDS,
        play: rest::play,
    },
    Scene {
        name: "slide",
        about: slide::SLIDES,
        kinds: &KINDS,
        play: slide::slides,
    },
    Scene {
        name: "stick",
        about: slide::STICKS,
        kinds: &KINDS,
        play: slide::sticks,
    },
    Scene {
        name: "bounce",
        about: bounce::ABOUT,
        kinds: &KINDS,
        play: bounce::play,
    },
    Scene {
        name: "roll smoothly",
        about: roll::SMOOTHLY,
        kinds: &KINDS_AND_SEGMENTS,
        play: roll::smoothly,
    },
    Scene {
        name: "roll on",
        about: roll::ON,
        kinds: &KINDS_AND_SEGMENTS,
        play: roll::on,
    },
    Scene {
        name: "stack of gears",
        about: stack::GEARS,
        kinds: &KINDS_AND_SEGMENTS,
        play: stack::gears,
    },
    Scene {
        name: "stack of bunnies",
        about: stack::BUNNIES,
        kinds: &ALL_KINDS,
        play: stack::bunnies,
    },
    Scene {
        name: "bolt in nut",
        about: screw::ABOUT,
        kinds: &KINDS,
        play: screw::play,
    },
    Scene {
        name: "ring on a peg",
        about: ring::ABOUT,
        kinds: &KINDS,
        play: ring::play,
    },
    Scene {
        name: "chain",
        about: chain::ABOUT,
        kinds: &KINDS,
        play: chain::play,
    },
    Scene {
        name: "gear on gear",
        about: gears::ABOUT,
        kinds: &KINDS,
        play: gears::play,
    },
    Scene {
        name: "thin plate",
        about: thin::ABOUT,
        kinds: &KINDS,
        play: thin::play,
    },
    Scene {
        name: "millimetres",
        about: millimetre::ABOUT,
        kinds: &BUNNY_KINDS,
        play: millimetre::play,
    },
    Scene {
        name: "deep inside",
        about: deep::ABOUT,
        kinds: &BUNNY_KINDS,
        play: deep::play,
    },
    Scene {
        name: "pile",
        about: pile::ABOUT,
        kinds: &BUNNY_KINDS,
        play: pile::play,
    },
];

/// Turns the z axis of a model up.
fn upright() -> Rotation {
    Rotation::from_rotation_x(-std::f32::consts::FRAC_PI_2)
}

/// The angle of a rotation about its z axis, followed from step to step over whole turns.
#[derive(Clone, Copy, Debug)]
struct Turned {
    /// In radians since the start.
    total: f64,
    last: f64,
}

impl Turned {
    fn from(rotation: Rotation) -> Self {
        Self {
            total: 0.0,
            last: about_z(rotation),
        }
    }

    fn follow(&mut self, rotation: Rotation) {
        use std::f64::consts::{PI, TAU};
        let now = about_z(rotation);
        self.total += (now - self.last + PI).rem_euclid(TAU) - PI;
        self.last = now;
    }
}

fn about_z(rotation: Rotation) -> f64 {
    2.0 * f64::from(rotation.z).atan2(f64::from(rotation.w))
}
