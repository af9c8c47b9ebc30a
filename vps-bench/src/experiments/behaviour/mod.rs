//! Bodies in rapier worlds, set as a user would set them: scenes with a known outcome, played with
//! VPS, convex parts and triangle meshes.

mod collider;
mod core_time;
mod models;
mod patience;
mod persistence;
mod present;
mod record;
mod scenes;
mod setup;
mod stage;
mod summary;

use std::collections::BTreeMap;

use polars::prelude::DataFrame;
use serde::{Deserialize, Serialize};

use crate::config::validate::{not_negative, positive};
use crate::data::tables::Tables;
use crate::error::Error;
use crate::experiments::experiment::{Experiment, Measurement};
use crate::harness::context::Context;
use crate::harness::job::Job;
use crate::harness::prepare::Preparation;
use crate::report::document::Block;
use crate::report::page::Page;
use collider::Collider;
use core_time::CoreTime;
use models::{ModelSettings, Models};
use scenes::Scene;
use setup::Setup;

/// The scenes, and how they are played.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Settings {
    models: ModelSettings,
    /// Level of the segments, the top being 1.
    segments_level: u32,
    /// The distance two bodies move against each other before rapier asks for their contacts again,
    /// in millimetres for bodies of some decimetres. At 0 it asks in every step.
    recycling_mm: f64,
    /// Other such distances.
    other_recycling_mm: Vec<f64>,
    /// Number of other starts.
    starts: u32,
    /// Colliders that are also played with other contact recycling and from other starts.
    varied: Vec<Collider>,
    scenes: BTreeMap<Scene, SceneSettings>,
}

/// A scene, and when it goes as it should.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct SceneSettings {
    /// What happens, and the limits in words.
    about: String,
    colliders: Vec<Collider>,
    /// Whether it takes too long for other starts.
    #[serde(default)]
    has_one_start: bool,
    /// Quantities and the ranges they must be in.
    limits: BTreeMap<String, Limit>,
}

/// A range; a missing bound is no bound.
#[derive(Clone, Copy, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct Limit {
    at_least: Option<f64>,
    at_most: Option<f64>,
}

impl Limit {
    fn holds(self, value: f64) -> bool {
        self.at_least.is_none_or(|least| value >= least)
            && self.at_most.is_none_or(|most| value <= most)
    }
}

impl Settings {
    /// All distances of contact recycling, that of the tables first.
    fn recyclings_mm(&self) -> impl Iterator<Item = f64> {
        [self.recycling_mm]
            .into_iter()
            .chain(self.other_recycling_mm.iter().copied())
    }

    fn case(scene: Scene, recycling_mm: f64) -> String {
        format!("{}_{recycling_mm}mm", scene.name())
    }

    /// All scenes with all contact recycling.
    fn cases(&self) -> impl Iterator<Item = (Scene, f64)> {
        let of_scene = |&scene: &Scene| self.recyclings_mm().map(move |mm| (scene, mm));
        self.scenes.keys().flat_map(of_scene)
    }
}

impl Experiment for Settings {
    fn check(&self) -> Result<(), String> {
        let models = &self.models;
        positive("behaviour.models.bunny_scale", models.bunny_scale)?;
        positive(
            "behaviour.models.bunny_voxel_size_m",
            models.bunny_voxel_size_m,
        )?;
        positive("behaviour.segments_level", self.segments_level.into())?;
        for mm in self.recyclings_mm() {
            not_negative("behaviour.recycling_mm", mm)?;
        }
        for (scene, settings) in &self.scenes {
            if settings.limits.is_empty() || settings.colliders.is_empty() {
                let key = format!("behaviour.scenes.{}", scene.name());
                return Err(format!("{key} needs limits and colliders"));
            }
        }
        Ok(())
    }

    fn jobs(&self, quick: bool) -> Vec<Job> {
        let (mut jobs, mut last) = (Vec::new(), Vec::new());
        for (&scene, settings) in &self.scenes {
            for collider in &settings.colliders {
                let job = |recycling_mm: f64, seed: u32| {
                    Job::new(Self::case(scene, recycling_mm), collider.name(), seed)
                };
                let first = job(self.recycling_mm, 0);
                // They run on beside whatever comes after them.
                if scene.may_never_end(*collider) {
                    last.extend((!quick).then_some(first));
                    continue;
                }
                jobs.push(first);
                if quick || !self.varied.contains(collider) {
                    continue;
                }
                jobs.extend(self.other_recycling_mm.iter().map(|&mm| job(mm, 0)));
                if !settings.has_one_start {
                    jobs.extend((1..=self.starts).map(|start| job(self.recycling_mm, start)));
                }
            }
        }
        jobs.append(&mut last);
        jobs
    }

    fn planning_keys(&self) -> &'static [&'static str] {
        &[
            "recycling_mm",
            "other_recycling_mm",
            "starts",
            "varied",
            "scenes",
        ]
    }

    fn identity(&self, context: &Context) -> Result<String, String> {
        let models = &self.models;
        let body = context.body(&models.bunny, models.bunny_scale)?;
        Ok(body.identity.clone())
    }

    fn run(&self, job: &Job, context: &Context) -> Result<Measurement, String> {
        let name = |&(scene, mm): &(Scene, f64)| Self::case(scene, mm);
        let (scene, recycling_mm) = job.find_case(self.cases(), name)?;
        let mut colliders = Collider::ALL.into_iter();
        let collider = colliders.find(|c| c.name() == job.algorithm);
        let models = || Models::new(&self.models, context);
        let setup = Setup {
            models: context.once(&format!("{:?}", self.models), models)?,
            collider: collider.ok_or_else(|| format!("no collider `{}`", job.algorithm))?,
            segments_level: self.segments_level,
            recycling_mm,
            start: job.seed,
        };
        let start = CoreTime::of_now();
        let record = scene.play(&setup)?;
        let record = record.with("waited_percent", start.waited_percent());
        Measurement::of(record.rows(), &Preparation::default())
    }

    fn summarize(&self, rows: &DataFrame) -> Result<Tables, Error> {
        summary::summarize(self, rows)
    }

    fn present(&self, page: &Page<'_>) -> Result<Vec<Block>, Error> {
        present::present(self, page)
    }
}
