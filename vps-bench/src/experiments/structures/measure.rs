//! One build: its times, and the sizes of the asset.

use std::cell::RefCell;
use std::time::Instant;

use serde::Serialize;
use vps_build::{BuildOptions, ClosestPoints, PointCount, Stage, build};
use vps_core::{Asset, Cluster, encode};

use super::{Settings, VOXELMAPS, clustering, vps};
use crate::experiments::experiment::Measurement;
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
    let whole = vps(&context.algorithms, &job.algorithm)?.build_options();
    let map = VOXELMAPS.iter().find(|(case, _)| *case == job.case);
    let options = match (map, clustering(&job.case, job.seed)) {
        (Some((_, map)), _) => BuildOptions {
            encoding: map.encoding,
            density: map.density,
            closest_points: if map.is_by_descent {
                ClosestPoints::GradientDescent
            } else {
                ClosestPoints::Exact
            },
            // Only the map is measured.
            points: PointCount::About(1),
            ..whole
        },
        (None, Some(clustering)) => BuildOptions {
            clustering,
            ..whole
        },
        (None, None) => return Err(format!("no case `{}`", job.case)),
    };
    let begun: RefCell<Vec<(Stage, Instant)>> = RefCell::default();
    let built = build(&body.mesh, &options, &|stage| {
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
        file_bytes: encode(&asset).len(),
        near_error_m: error_bounds.in_band,
        far_error_m: error_bounds.beyond,
        points: asset.tree.point_count(),
        levels: asset.tree.level_count(),
        voxels_s: seconds(Stage::Voxels),
        distances_s: seconds(Stage::Distances),
        points_s: seconds(Stage::Points),
        tree_s: seconds(Stage::Tree),
        ..Row::default()
    };
    let build_s = row.voxels_s + row.distances_s + row.points_s + row.tree_s;
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
            children_mean: Some(mean(&|c| c.count.into())),
            children_max: clusters.iter().map(|c| c.count).max(),
            radius_m_mean: Some(mean(&|c| c.radius.into())),
            radius_m_max: clusters.iter().map(|c| c.radius).reduce(f32::max),
            ..whole.clone()
        }
    };
    (1..=asset.tree.level_count()).map(of_level).collect()
}
