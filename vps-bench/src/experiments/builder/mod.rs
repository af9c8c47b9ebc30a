//! The builder: its speed, the sizes of what it makes, the errors of stored distances, its memory, and
//! the same grid by another program.

#[path = "../../../../vps-build/tests/it/brute_force.rs"]
mod brute_force;
mod errors;
mod measure;
mod peak_memory;
mod present;
mod summary;

use polars::prelude::DataFrame;
use serde::{Deserialize, Serialize};
use vps_build::{BuildOptions, PointCount, Resolution};

use crate::config::validate::positive;
use crate::data::tables::Tables;
use crate::error::Error;
use crate::experiments::experiment::{Experiment, Measurement};
use crate::experiments::shared::voxelmaps::VOXELMAPS;
use crate::harness::context::Context;
use crate::harness::job::Job;
use crate::report::document::Block;
use crate::report::page::Page;

/// The mesh, how it is built, and how errors are sampled.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Settings {
    /// A name in `models.toml` or the path of a mesh.
    model: String,
    /// Length of a unit of the model in metres.
    scale: f64,
    voxel_size_m: f64,
    points: u32,
    /// Layers of voxels around the mesh.
    margin: u32,
    /// The same for the smaller grid that is compared with another program.
    narrow_margin: u32,
    /// Subdivisions of the fine mesh, each of which makes four triangles of one.
    subdivisions: u32,
    /// Repetitions of builds; the median time counts. Those that take half a minute are not
    /// repeated.
    builds: u32,
    quick_builds: u32,
    /// Voxels compared with brute force, within `band_voxels` of the surface and elsewhere, and sphere
    /// tests.
    samples: usize,
    band_voxels: f32,
    voxel_seed: u64,
    sphere_seed: u64,
}

/// Cases: whole assets, maps by encoding, grids by program, sphere tests, and memory.
const ASSET: &str = "asset";
const MAP: &str = "map";
const NARROW_GRID: &str = "narrow_grid";
const WIDE_GRID: &str = "wide_grid";
const SPHERES: &str = "spheres";
const MEMORY: &str = "memory";

/// Meshes of whole assets.
const MESHES: [&str; 2] = ["given", "fine"];
/// Programs that fill a grid.
const SPARSE: &str = "vps_build_sparse";
const DENSE: &str = "vps_build_dense";
const PEER: &str = "mesh_to_sdf";
/// The contestant of the cases of the builder alone.
const BUILDER: &str = "vps_build";

impl Settings {
    /// Options of the whole asset.
    fn options(&self) -> BuildOptions {
        BuildOptions {
            resolution: Resolution::VoxelSize(self.voxel_size_m),
            margin: self.margin,
            points: PointCount::About(self.points),
            ..BuildOptions::default()
        }
    }

    /// Options of a map without a pointshell.
    fn map_options(&self, margin: u32) -> BuildOptions {
        BuildOptions {
            margin,
            points: PointCount::About(1),
            ..self.options()
        }
    }
}

impl Experiment for Settings {
    fn check(&self) -> Result<(), String> {
        positive("builder.scale", self.scale)?;
        positive("builder.voxel_size_m", self.voxel_size_m)?;
        positive("builder.builds", self.builds.into())?;
        positive("builder.quick_builds", self.quick_builds.into())?;
        positive("builder.samples", self.samples as f64)?;
        positive("builder.band_voxels", self.band_voxels.into())?;
        positive("builder.margin", self.margin.into())?;
        positive("builder.narrow_margin", self.narrow_margin.into())?;
        if self.subdivisions > 4 {
            return Err("builder.subdivisions must be 4 or less".into());
        }
        Ok(())
    }

    fn model_mut(&mut self) -> Option<(&mut String, &mut f64)> {
        Some((&mut self.model, &mut self.scale))
    }

    fn model(&self) -> Option<(&str, f64)> {
        Some((&self.model, self.scale))
    }

    fn jobs(&self, quick: bool) -> Vec<Job> {
        let builds = if quick {
            self.quick_builds
        } else {
            self.builds
        };
        let mut jobs = Vec::new();
        for seed in 0..builds {
            jobs.extend(MESHES.map(|mesh| Job::new(ASSET, mesh, seed)));
            jobs.extend([SPARSE, DENSE, PEER].map(|program| Job::new(NARROW_GRID, program, seed)));
        }
        jobs.push(Job::new(SPHERES, BUILDER, 0));
        jobs.push(Job::new(MEMORY, BUILDER, 0));
        for (name, map) in VOXELMAPS {
            if !(quick && map.is_slow()) {
                jobs.push(Job::new(MAP, name, 0));
            }
        }
        if !quick {
            jobs.extend([SPARSE, DENSE, PEER].map(|program| Job::new(WIDE_GRID, program, 0)));
        }
        jobs
    }

    fn planning_keys(&self) -> &'static [&'static str] {
        &["builds", "quick_builds"]
    }

    fn identity(&self, context: &Context) -> Result<String, String> {
        Ok(context.body(&self.model, self.scale)?.identity.clone())
    }

    fn run(&self, job: &Job, context: &Context) -> Result<Measurement, String> {
        measure::run(self, job, context)
    }

    fn summarize(&self, rows: &DataFrame) -> Result<Tables, Error> {
        summary::summarize(rows)
    }

    fn present(&self, page: &Page<'_>) -> Result<Vec<Block>, Error> {
        present::present(page)
    }
}
