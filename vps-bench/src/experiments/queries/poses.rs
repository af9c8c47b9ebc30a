//! Poses of a body in the frame of the ground.

use std::sync::Arc;

use rapier3d::math::{Pose, Vector};
use vps_core::Asset;

use super::Settings;
use crate::harness::context::Context;

/// Poses of a body that fell on the ground, and what becomes of them.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(super) enum PoseSet {
    /// On the ground, with contacts predicted.
    GroundAhead,
    /// On the ground.
    Ground,
    /// All points inside a box.
    Inside,
    /// Apart from the ground by about twice the body's size, with contacts predicted.
    Apart,
}

impl PoseSet {
    pub(super) const ALL: [Self; 4] = [Self::GroundAhead, Self::Ground, Self::Inside, Self::Apart];

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::GroundAhead => "ground_ahead",
            Self::Ground => "ground",
            Self::Inside => "inside",
            Self::Apart => "apart",
        }
    }

    pub(super) fn label(self) -> &'static str {
        match self {
            Self::GroundAhead => "on the ground, contacts predicted",
            Self::Ground => "on the ground",
            Self::Inside => "all points inside a box",
            Self::Apart => "apart, contacts predicted",
        }
    }
}

impl Settings {
    /// Poses of all falls: some steps in a row, as an engine asks.
    ///
    /// # Errors
    /// When the body cannot be simulated, or the fall is too short.
    pub(super) fn fallen(&self, context: &Context) -> Result<Arc<Vec<Pose>>, String> {
        context.once(&format!("{self:?}"), || {
            let up = Vector::new(0.0, 0.5 * self.fall.ground_extents_m[1] as f32, 0.0);
            let mut poses = Vec::new();
            for seed in 0..self.fall.seeds(false) {
                let trace = self.fall.trace(context, seed)?;
                for &first in &self.first_steps {
                    let steps = trace.get(first..first + self.steps_in_a_row);
                    let steps = steps.ok_or("queries.first_steps go beyond the fall")?;
                    let in_ground = |p: &Pose| Pose::from_parts(p.translation + up, p.rotation);
                    poses.extend(steps.iter().map(in_ground));
                }
            }
            Ok(poses)
        })
    }

    /// One pose of each row of steps.
    pub(super) fn fallen_once(&self, context: &Context) -> Result<Vec<Pose>, String> {
        let poses = self.fallen(context)?;
        Ok(poses.iter().step_by(self.steps_in_a_row).copied().collect())
    }

    /// The poses of a set, and their prediction distance.
    pub(super) fn poses(
        &self,
        set: PoseSet,
        shell: &Asset<'_>,
        context: &Context,
    ) -> Result<(Vec<Pose>, f32), String> {
        let ahead = self.fall.prediction_m;
        let fallen = self.fallen(context)?;
        Ok(match set {
            PoseSet::GroundAhead => (fallen.to_vec(), ahead),
            PoseSet::Ground => (fallen.to_vec(), 0.0),
            PoseSet::Inside => {
                let centered =
                    |p: Pose| Pose::from_parts(-(p.rotation * shell.mass.center()), p.rotation);
                let poses = self.fallen_once(context)?.into_iter();
                (poses.map(centered).collect(), 0.0)
            }
            PoseSet::Apart => {
                let up = Vector::new(0.0, self.apart_m, 0.0);
                let raised = |p: &Pose| Pose::from_parts(p.translation + up, p.rotation);
                (fallen.iter().map(raised).collect(), ahead)
            }
        })
    }
}
