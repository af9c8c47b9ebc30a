//! Builds without a cache, timed stage by stage.

use std::cell::RefCell;
use std::time::Instant;

use vps_build::{BuildOptions, Mesh, Stage, build};
use vps_core::Asset;

/// Times of the stages of a build that follow the reading and repairing of the mesh.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StageTimes {
    pub(crate) voxels_s: f64,
    pub(crate) distances_s: f64,
    pub(crate) points_s: f64,
    pub(crate) tree_s: f64,
}

impl StageTimes {
    /// All stages together.
    pub(crate) fn total_s(&self) -> f64 {
        self.voxels_s + self.distances_s + self.points_s + self.tree_s
    }
}

/// Builds an asset.
pub(crate) fn timed_build(
    mesh: &Mesh,
    options: &BuildOptions,
) -> Result<(Asset<'static>, StageTimes), String> {
    let begun: RefCell<Vec<(Stage, Instant)>> = RefCell::default();
    let built = build(mesh, options, &|stage| {
        begun.borrow_mut().push((stage, Instant::now()));
    });
    let end = Instant::now();
    let asset = built.map_err(|e| e.to_string())?.asset;
    let begun = begun.into_inner();
    let seconds = |stage: Stage| {
        let at = begun.iter().position(|(s, _)| *s == stage);
        let next = |at: usize| begun.get(at + 1).map_or(end, |(_, next)| *next);
        at.map_or(0.0, |at| (next(at) - begun[at].1).as_secs_f64())
    };
    let times = StageTimes {
        voxels_s: seconds(Stage::Voxels),
        distances_s: seconds(Stage::Distances),
        points_s: seconds(Stage::Points),
        tree_s: seconds(Stage::Tree),
    };
    Ok((asset, times))
}
