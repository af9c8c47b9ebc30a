//! One build: its times, and the sizes of the asset.

use serde::Serialize;
use vps_build::BuildOptions;
use vps_core::{Asset, Cluster};

use super::{Settings, clustering};
use crate::experiments::experiment::Measurement;
use crate::experiments::shared::timed_build::timed_build;
use crate::experiments::shared::voxelmaps::VOXELMAPS;
use crate::harness::context::Context;
use crate::harness::job::Job;
use crate::harness::prepare::Preparation;

/// An asset, or a level of its tree.
#[derive(Clone, Debug, Default, Serialize)]
struct Row {
    /// Level of the tree from 1 at the top; 0 for the whole asset.
    level: u32,
    voxels_x: u32,
    voxels_y: u32,
    voxels_z: u32,
    /// Stored values.
    values: usize,
    map_bytes: usize,
    /// Size of points, normals, areas and clusters.
    tree_bytes: usize,
    file_bytes: usize,
    /// Error bounds of the map, near the surface and elsewhere.
    near_error_m: f32,
    far_error_m: f32,
    points: usize,
    levels: u32,
    voxels_s: f64,
    distances_s: f64,
    points_s: f64,
    tree_s: f64,
    /// Clusters of the level.
    clusters: Option<usize>,
    children_mean: Option<f64>,
    children_max: Option<u32>,
    radius_m_mean: Option<f64>,
    radius_m_max: Option<f32>,
}

/// Builds the asset of a job without a cache, and times the stages.
pub(super) fn run(
    settings: &Settings,
    job: &Job,
    context: &Context,
) -> Result<Measurement, String> {
    let body = context.body(&settings.model, settings.scale)?;
    let whole = context.algorithms.vps(&job.algorithm)?.build_options();
    let map = VOXELMAPS.iter().find(|(case, _)| *case == job.case);
    let options = match (map, clustering(&job.case, job.seed)) {
        (Some((_, map)), _) => map.options(whole),
        (None, Some(clustering)) => BuildOptions {
            clustering,
            ..whole
        },
        (None, None) => return Err(format!("no case `{}`", job.case)),
    };
    let (asset, times) = timed_build(&body.mesh, &options)?;
    let [voxels_x, voxels_y, voxels_z] = asset.voxelmap.grid().dims();
    let store = asset.voxelmap.store();
    let error_bounds = asset.voxelmap.error_bounds();
    let row = Row {
        voxels_x,
        voxels_y,
        voxels_z,
        values: store.values().len(),
        map_bytes: store.byte_len(),
        tree_bytes: asset.tree.byte_len(),
        file_bytes: asset.to_bytes().len(),
        near_error_m: error_bounds.in_band,
        far_error_m: error_bounds.beyond,
        points: asset.tree.point_count(),
        levels: asset.tree.level_count(),
        voxels_s: times.voxels_s,
        distances_s: times.distances_s,
        points_s: times.points_s,
        tree_s: times.tree_s,
        ..Row::default()
    };
    let build_s = times.total_s();
    let preparation = Preparation {
        prepare_s: build_s,
        asset_build_s: Some(build_s),
        size: format!("{} points, {} levels", row.points, row.levels),
        asset_bytes: row.file_bytes as u64,
        memory_bytes: (row.map_bytes + row.tree_bytes) as u64,
        ..Preparation::default()
    };
    let mut rows = vec![row];
    if map.is_none() {
        rows.extend(levels(&asset, &rows[0]));
    }
    Measurement::of(&rows, &preparation)
}

/// A row for each level, with the columns of the whole asset.
fn levels(asset: &Asset<'_>, whole: &Row) -> Vec<Row> {
    let of_level = |level: u32| {
        let clusters = asset.tree.level(level);
        let mean = |value: &dyn Fn(&Cluster) -> f64| {
            clusters.iter().map(value).sum::<f64>() / clusters.len() as f64
        };
        Row {
            level,
            clusters: Some(clusters.len()),
            children_mean: Some(mean(&|c| c.children().len() as f64)),
            children_max: clusters.iter().map(|c| c.children().len() as u32).max(),
            radius_m_mean: Some(mean(&|c| c.radius().into())),
            radius_m_max: clusters.iter().map(Cluster::radius).reduce(f32::max),
            ..whole.clone()
        }
    };
    (1..=asset.tree.level_count()).map(of_level).collect()
}
