//! How a scene is played.

use std::sync::Arc;

use rapier3d::prelude::*;

use super::collider::Collider;
use super::models::{Model, ModelName, Models};

/// What a scene does not determine itself.
#[derive(Clone)]
pub(super) struct Setup {
    pub(super) models: Arc<Models>,
    pub(super) collider: Collider,
    /// Level of the segments of [`Collider::VpsSegments`], the top being 1.
    pub(super) segments_level: u32,
    /// The distance two bodies move against each other before rapier asks for their contacts again,
    /// in millimetres for bodies of some decimetres; at 0 it asks in every step.
    pub(super) recycling_mm: f64,
    /// The start: 0 as the scene has it, others a little aside of it.
    pub(super) start: u32,
}

/// By how much of its size another start displaces a body along each axis, and turns it in radians.
const ASIDE: f32 = 0.005;

impl Setup {
    pub(super) fn model(&self, name: ModelName) -> Result<&Model, String> {
        self.models.get(name)
    }

    pub(super) fn set_recycling(&self, parameters: &mut IntegrationParameters) {
        parameters.contact_recycling = self.recycling_mm > 0.0;
        if parameters.contact_recycling {
            let metres = self.recycling_mm / 1000.0;
            parameters.normalized_contact_recycle_distance = metres as f32;
        }
    }

    /// The displacement of the `n`th body, of a size in metres, at its start.
    pub(super) fn aside(&self, n: usize, size: f32) -> Pose {
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
