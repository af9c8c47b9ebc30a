//! How a scene is played.

use rapier3d::prelude::*;

use crate::models::Kind;

/// What a scene does not say itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Setup {
    /// What bodies collide as.
    pub(crate) kind: Kind,
    pub(crate) recycling: Recycling,
    /// Which start: 0 as the scene has it, others a little aside of it.
    pub(crate) start: u32,
}

/// How far two bodies may move against each other before rapier asks for their contacts again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Recycling {
    /// Contacts are asked for in every step.
    Off,
    /// As the README of vps-rapier has it: 2 mm for bodies of some decimetres.
    Close,
    /// rapier's own setting, 50 mm.
    Default,
}

/// All of them.
pub(crate) const RECYCLINGS: [Recycling; 3] =
    [Recycling::Off, Recycling::Close, Recycling::Default];

/// [`Recycling::Close`] in units of length.
const CLOSE: f32 = 0.002;

/// By how much of its size another start of a body may be aside along each axis, and turned in
/// radians.
const ASIDE: f32 = 0.005;

impl Recycling {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Off => "off",
            Self::Close => "2 mm",
            Self::Default => "50 mm",
        }
    }

    pub(crate) fn set(self, parameters: &mut IntegrationParameters) {
        parameters.contact_recycling = self != Self::Off;
        if self == Self::Close {
            parameters.normalized_contact_recycle_distance = CLOSE;
        }
    }
}

impl Setup {
    /// Of a kind, as the tables have it.
    pub(crate) fn new(kind: Kind) -> Self {
        Self {
            kind,
            recycling: Recycling::Close,
            start: 0,
        }
    }

    /// Where the `n`th body of a size in metres starts.
    pub(crate) fn aside(self, n: usize, size: f32) -> Pose {
        if self.start == 0 {
            return Pose::IDENTITY;
        }
        let seed = self.start as f32 * 17.0 + n as f32 * 5.0;
        // As good as random, and the same everywhere.
        let within = |i: u8| (seed + f32::from(i)).sin() * ASIDE;
        let [x, y, z] = [0, 1, 2].map(within);
        let turned = Rotation::from_scaled_axis(Vector::from([3, 4, 5].map(within)));
        Pose::from_parts(Vector::new(x, y, z) * size, turned)
    }
}
