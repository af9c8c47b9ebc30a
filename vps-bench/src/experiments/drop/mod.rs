//! A body falls on the ground, simulated by each algorithm.

mod present;
mod simulate;
mod summary;

use std::rc::Rc;

use polars::prelude::DataFrame;
use rapier3d::math::Pose;
use serde::{Deserialize, Serialize};

use self::simulate::StepRow;
use crate::config::validate::{not_negative, positive};
use crate::data::tables::Tables;
use crate::error::Error;
use crate::experiments::experiment::{Experiment, Measurement};
use crate::harness::context::{Body, Context};
use crate::harness::job::Job;
use crate::harness::prepare::PreparedAlgorithm;
use crate::report::document::Block;
use crate::report::page::Page;

/// The falling body, the ground, and the start.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Settings {
    /// A name in `models.toml` or the path of a mesh.
    model: String,
    /// Length of a unit of the model in metres.
    scale: f64,
    mass_kg: f32,
    friction: f32,
    restitution: f32,
    /// Edge lengths of the box.
    pub(super) ground_extents_m: [f64; 3],
    gravity_m_s2: f32,
    /// Height of the centre of mass above the ground.
    drop_height_m: f32,
    /// Prediction distance of contacts, for all algorithms.
    pub(super) prediction_m: f32,
    duration_s: f64,
    /// The measured interval, from and to.
    measured_s: [f64; 2],
    /// One case for each.
    pub(super) frequencies_hz: Vec<u32>,
    /// Number of random start orientations, and in a quick run.
    orientations: u32,
    quick_orientations: u32,
    seed: u64,
    pub(super) algorithms: Vec<String>,
    /// The algorithm that ratios refer to.
    reference: Option<String>,
    show: Vec<Show>,
    #[serde(default)]
    paper_value: Vec<PaperValue>,
}

/// A group of tables and figures in the report.
#[derive(Clone, Copy, Debug, Deserialize, Eq, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
enum Show {
    /// Times of queries: a row for each algorithm, and curves over steps.
    QueryTimes,
    /// Linear velocity over steps.
    LinearVelocity,
    /// Kinetic energy over steps.
    KineticEnergy,
    /// How evenly the body rolls.
    Spin,
    /// Whether the body is held, by frequency.
    Frequencies,
}

/// The mean time of a query as printed in the paper.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct PaperValue {
    algorithm: String,
    query_us: f64,
    /// Its place in the paper.
    source: String,
}

impl Settings {
    fn case(frequency: u32) -> String {
        format!("{frequency}hz")
    }

    /// The number of start orientations.
    pub(super) fn seeds(&self, quick: bool) -> u32 {
        if quick {
            self.quick_orientations
        } else {
            self.orientations
        }
    }

    /// The number of steps at a frequency.
    fn steps(&self, frequency: u32) -> u32 {
        (self.duration_s * f64::from(frequency)).round() as u32
    }

    /// The first measured step and the one after the last.
    fn measured_steps(&self, frequency: u32) -> [u32; 2] {
        self.measured_s
            .map(|s| (s * f64::from(frequency)).round() as u32)
    }

    pub(super) fn body(&self, context: &Context) -> Result<Rc<Body>, String> {
        context.body(&self.model, self.scale)
    }

    /// The body, and an algorithm prepared for it and the ground.
    pub(super) fn prepare(
        &self,
        context: &Context,
        algorithm: &str,
    ) -> Result<(Rc<Body>, Rc<PreparedAlgorithm>), String> {
        let body = self.body(context)?;
        let ready = context.prepare_on_box(algorithm, &body, self.ground_extents_m)?;
        Ok((body, ready))
    }

    /// The time between two steps at the first frequency in seconds.
    pub(super) fn step_s(&self) -> f64 {
        1.0 / f64::from(self.frequencies_hz[0])
    }

    /// The poses of the queries of the first algorithm at the first frequency, one for each step.
    /// The upper side of the ground is at height 0.
    pub(super) fn trace(&self, context: &Context, seed: u32) -> Result<Vec<Pose>, String> {
        let (body, ready) = self.prepare(context, &self.algorithms[0])?;
        let prepared = ready.prepared()?;
        let steps = self.simulate(&body, prepared, self.frequencies_hz[0], seed)?;
        Ok(steps.iter().map(StepRow::pose).collect())
    }

    fn paper_value(&self, algorithm: &str) -> Option<&PaperValue> {
        self.paper_value.iter().find(|v| v.algorithm == algorithm)
    }
}

impl Experiment for Settings {
    fn check(&self) -> Result<(), String> {
        positive("drop.mass_kg", self.mass_kg.into())?;
        positive("drop.drop_height_m", self.drop_height_m.into())?;
        positive("drop.prediction_m", self.prediction_m.into())?;
        positive("drop.duration_s", self.duration_s)?;
        not_negative("drop.friction", self.friction.into())?;
        not_negative("drop.restitution", self.restitution.into())?;
        not_negative("drop.gravity_m_s2", self.gravity_m_s2.into())?;
        for extent in self.ground_extents_m {
            positive("drop.ground_extents_m", extent)?;
        }
        for &frequency in &self.frequencies_hz {
            positive("drop.frequencies_hz", frequency.into())?;
        }
        let [from, to] = self.measured_s;
        if !(0.0 <= from && from < to && to <= self.duration_s) {
            return Err(format!(
                "drop.measured_s must grow and end by drop.duration_s = {}, but are {from}, {to}",
                self.duration_s
            ));
        }
        if self.orientations == 0 || self.quick_orientations == 0 {
            return Err("drop.orientations and drop.quick_orientations must be 1 or more".into());
        }
        if self.algorithms.is_empty() || self.frequencies_hz.is_empty() {
            return Err("drop.algorithms and drop.frequencies_hz must not be empty".into());
        }
        for (i, name) in self.algorithms.iter().enumerate() {
            if self.algorithms[..i].contains(name) {
                return Err(format!("drop.algorithms: `{name}` stands twice"));
            }
        }
        let named = self.paper_value.iter().map(|value| &value.algorithm);
        for name in named.chain(&self.reference) {
            if !self.algorithms.contains(name) {
                return Err(format!("`{name}` is not one of drop.algorithms"));
            }
        }
        Ok(())
    }

    fn model_mut(&mut self) -> Option<(&mut String, &mut f64)> {
        Some((&mut self.model, &mut self.scale))
    }

    fn model(&self) -> Option<(&str, f64)> {
        Some((self.model.as_str(), self.scale))
    }

    fn algorithms(&self) -> Vec<&str> {
        self.algorithms.iter().map(String::as_str).collect()
    }

    fn jobs(&self, quick: bool) -> Vec<Job> {
        let cases = self.frequencies_hz.iter().map(|f| Self::case(*f));
        let cases: Vec<_> = cases.collect();
        Job::of_all(self.seeds(quick), &cases, &self.algorithms)
    }

    fn planning_keys(&self) -> &'static [&'static str] {
        &[
            "frequencies_hz",
            "orientations",
            "quick_orientations",
            "measured_s",
            "algorithms",
            "reference",
            "show",
            "paper_value",
        ]
    }

    fn identity(&self, context: &Context) -> Result<String, String> {
        Ok(self.body(context)?.identity.clone())
    }

    fn run(&self, job: &Job, context: &Context) -> Result<Measurement, String> {
        let (body, ready) = self.prepare(context, &job.algorithm)?;
        let prepared = ready.prepared()?;
        let frequency = job.find_case(self.frequencies_hz.iter().copied(), |f| Self::case(*f))?;
        let rows = self.simulate(&body, prepared, frequency, job.seed)?;
        Measurement::of(&rows, &ready.preparation)
    }

    fn summarize(&self, rows: &DataFrame) -> Result<Tables, Error> {
        summary::summarize(self, rows)
    }

    fn present(&self, page: &Page<'_>) -> Result<Vec<Block>, Error> {
        present::present(self, page)
    }
}
