//! The scenes, one a file.

mod bolt;
mod bounce;
mod chain;
mod deep;
mod gears;
mod millimetre;
mod pile;
mod rest;
mod ring;
mod roll;
mod slide;
mod stack;
mod thin;

use rapier3d::prelude::*;
use serde::{Deserialize, Serialize};

use super::collider::Collider;
use super::record::Record;
use super::setup::Setup;

/// A situation with a known outcome.
#[derive(Clone, Copy, Debug, Deserialize, Eq, Ord, PartialEq, PartialOrd, Serialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Scene {
    Rest,
    Slide,
    Stick,
    Bounce,
    RollSmoothly,
    RollOn,
    StackOfGears,
    StackOfBunnies,
    BoltInNut,
    RingOnAPeg,
    Chain,
    GearOnGear,
    ThinPlate,
    Millimetres,
    DeepInside,
    Pile,
}

/// The quantity a scene is about.
pub(super) struct Subject {
    pub(super) quantity: &'static str,
    /// In words, with its unit.
    pub(super) label: &'static str,
}

impl Scene {
    /// Its name in settings and records.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Rest => "rest",
            Self::Slide => "slide",
            Self::Stick => "stick",
            Self::Bounce => "bounce",
            Self::RollSmoothly => "roll_smoothly",
            Self::RollOn => "roll_on",
            Self::StackOfGears => "stack_of_gears",
            Self::StackOfBunnies => "stack_of_bunnies",
            Self::BoltInNut => "bolt_in_nut",
            Self::RingOnAPeg => "ring_on_a_peg",
            Self::Chain => "chain",
            Self::GearOnGear => "gear_on_gear",
            Self::ThinPlate => "thin_plate",
            Self::Millimetres => "millimetres",
            Self::DeepInside => "deep_inside",
            Self::Pile => "pile",
        }
    }

    /// Its name in words.
    pub(super) fn label(self) -> String {
        self.name().replace('_', " ")
    }

    pub(super) fn subject(self) -> Subject {
        let (quantity, label) = match self {
            Self::Rest | Self::StackOfBunnies | Self::Millimetres => {
                ("speed_mm_s", "highest speed, mm/s")
            }
            Self::Slide => ("acceleration_off_percent", "acceleration off by, %"),
            Self::Stick => ("drift_mm", "drift, mm"),
            Self::Bounce => ("height_ratio", "height after / before"),
            Self::RollSmoothly => ("spin_step_percent", "largest change of spin in a step, %"),
            Self::RollOn => ("spin_lost_percent", "spin lost, %"),
            Self::StackOfGears => ("top_off_mm", "topmost off by, mm"),
            Self::BoltInNut => ("pitch_off_percent", "descent per turn off by, %"),
            Self::RingOnAPeg => ("off_axis_mm", "centre off the peg's axis by, mm"),
            Self::Chain => ("stretch_mm", "neighbours too far apart by, mm"),
            Self::GearOnGear => ("ratio_off_percent", "ratio off by, %"),
            Self::ThinPlate => ("deepest_mm", "deepest, mm"),
            Self::DeepInside => ("apart_after_s", "apart after, s"),
            Self::Pile => ("settled_steps_per_s", "steps per second when settled"),
        };
        Subject { quantity, label }
    }

    /// Whether a step may take longer than anyone waits for it.
    pub(super) fn may_never_end(self, collider: Collider) -> bool {
        collider == Collider::Trimesh && matches!(self, Self::DeepInside | Self::Pile)
    }

    /// Plays the scene.
    ///
    /// # Errors
    /// When a model or its shape cannot be made.
    pub(super) fn play(self, setup: &Setup) -> Result<Record, String> {
        match self {
            Self::Rest => rest::play(setup),
            Self::Slide => slide::slides(setup),
            Self::Stick => slide::sticks(setup),
            Self::Bounce => bounce::play(setup),
            Self::RollSmoothly | Self::RollOn => roll::play(setup),
            Self::StackOfGears => stack::gears(setup),
            Self::StackOfBunnies => stack::bunnies(setup),
            Self::BoltInNut => bolt::play(setup),
            Self::RingOnAPeg => ring::play(setup),
            Self::Chain => chain::play(setup),
            Self::GearOnGear => gears::play(setup),
            Self::ThinPlate => thin::play(setup),
            Self::Millimetres => millimetre::play(setup),
            Self::DeepInside => deep::play(setup),
            Self::Pile => pile::play(setup),
        }
    }
}

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_are_followed_over_whole_turns() {
        let mut turned = Turned::from(Rotation::IDENTITY);
        for step in 1..=100 {
            turned.follow(Rotation::from_rotation_z(0.2 * step as f32));
        }
        assert!((turned.total - 20.0).abs() < 1e-4, "{}", turned.total);
    }
}
