//! What bodies collide as.

use serde::{Deserialize, Serialize};

/// The kind of shape all bodies of a scene collide as.
#[derive(Clone, Copy, Debug, Deserialize, Eq, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Collider {
    /// VPS with the coarse shell of the bunny.
    VpsCoarse,
    Vps,
    /// VPS with a contact for each segment of a level of the shell's tree.
    VpsSegments,
    /// Convex parts by VHACD.
    Decomposition,
    /// A triangle mesh of parry.
    Trimesh,
}

impl Collider {
    pub(super) const ALL: [Self; 5] = [
        Self::VpsCoarse,
        Self::Vps,
        Self::VpsSegments,
        Self::Decomposition,
        Self::Trimesh,
    ];

    /// Its name in settings and records.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::VpsCoarse => "vps_coarse",
            Self::Vps => "vps",
            Self::VpsSegments => "vps_segments",
            Self::Decomposition => "decomposition",
            Self::Trimesh => "trimesh",
        }
    }

    /// Its name in the report.
    pub(super) fn label(self) -> &'static str {
        match self {
            Self::VpsCoarse => "VPS, coarse",
            Self::Vps => "VPS",
            Self::VpsSegments => "VPS, segments",
            Self::Decomposition => "convex decomposition",
            Self::Trimesh => "triangle mesh",
        }
    }

    pub(super) fn is_vps(self) -> bool {
        matches!(self, Self::VpsCoarse | Self::Vps | Self::VpsSegments)
    }
}
