//! The structures of an asset: sizes and build times of voxelmaps and pointshells, and pictures of
//! them.

mod measure;
mod pictures;
mod present;
mod summary;

use std::path::Path;

use polars::prelude::DataFrame;
use serde::{Deserialize, Serialize};
use vps_build::Clustering;

use crate::config::validate::positive;
use crate::data::tables::Tables;
use crate::error::Error;
use crate::experiments::drop;
use crate::experiments::experiment::{Experiment, Measurement};
use crate::experiments::shared::voxelmaps::VOXELMAPS;
use crate::harness::context::Context;
use crate::harness::job::Job;
use crate::report::document::Block;
use crate::report::page::Page;

/// The assets that are built and drawn.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Settings {
    /// A name in `models.toml` or the path of a mesh.
    model: String,
    /// Length of a unit of the model in metres.
    scale: f64,
    /// Algorithms of the method `vps`, one pointshell for each, from coarse to fine. The last
    /// determines the voxelmaps.
    shells: Vec<String>,
    /// Repetitions of each build; the median time counts.
    builds: u32,
    quick_builds: u32,
    /// Algorithms that are drawn beside the segments.
    hull: String,
    decomposition: String,
    /// The level of the tree whose clusters are the segments that are drawn.
    segments_level: u32,
    /// Voxels along the longest side where voxels are drawn one by one.
    drawn_voxels: u32,
    /// The step whose pose the traversal is drawn at, and the depth the body is moved to.
    traverse_step: u32,
    traverse_depth_m: f32,
    /// Steps of the fall that are drawn.
    fall_steps: Vec<u32>,
    /// The fall, of which the first job is drawn.
    fall: drop::Settings,
}

/// Cases of pointshells by clustering; the seed of `bottom_up` is the number of the build.
const SHELLS: [&str; 2] = ["bisect", "bottom_up"];

fn clustering(case: &str, seed: u32) -> Option<Clustering> {
    match case {
        "bisect" => Some(Clustering::Bisect),
        "bottom_up" => Some(Clustering::BottomUp { seed: seed.into() }),
        _ => None,
    }
}

impl Settings {
    /// The algorithm with the most points.
    fn finest(&self) -> &str {
        self.shells.last().map_or("", String::as_str)
    }
}

impl Experiment for Settings {
    fn check(&self) -> Result<(), String> {
        positive("structures.scale", self.scale)?;
        positive("structures.builds", self.builds.into())?;
        positive("structures.quick_builds", self.quick_builds.into())?;
        positive("structures.segments_level", self.segments_level.into())?;
        positive("structures.drawn_voxels", self.drawn_voxels.into())?;
        positive("structures.traverse_depth_m", self.traverse_depth_m.into())?;
        if self.shells.is_empty() || self.fall_steps.is_empty() {
            return Err("structures.shells and structures.fall_steps must not be empty".into());
        }
        self.fall.check()
    }

    fn replace_model(&mut self, model: &str, scale: Option<f64>) -> bool {
        self.model = model.into();
        self.scale = scale.unwrap_or(self.scale);
        self.fall.replace_model(model, scale)
    }

    fn algorithms(&self) -> Vec<&str> {
        let drawn = [self.hull.as_str(), &self.decomposition];
        let all = self.shells.iter().map(String::as_str).chain(drawn);
        all.chain(self.fall.algorithms()).collect()
    }

    fn jobs(&self, quick: bool) -> Vec<Job> {
        let builds = if quick {
            self.quick_builds
        } else {
            self.builds
        };
        let mut jobs = Vec::new();
        for seed in 0..builds {
            for (case, map) in VOXELMAPS {
                if !(quick && map.is_slow()) {
                    jobs.push(Job::new(case, self.finest(), seed));
                }
            }
            for algorithm in &self.shells {
                for case in SHELLS {
                    jobs.push(Job::new(case, algorithm, seed));
                }
            }
        }
        jobs
    }

    fn planning_keys(&self) -> &'static [&'static str] {
        &[
            "shells",
            "builds",
            "quick_builds",
            "hull",
            "decomposition",
            "segments_level",
            "drawn_voxels",
            "traverse_step",
            "traverse_depth_m",
            "fall_steps",
            "fall",
        ]
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

    fn draw(&self, context: &Context, folder: &Path) -> Result<(), Error> {
        Ok(pictures::draw(self, context, folder)?)
    }

    fn present(&self, page: &Page<'_>) -> Result<Vec<Block>, Error> {
        present::present(self, page)
    }
}
