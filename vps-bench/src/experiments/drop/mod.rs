//! A body falls on the ground, simulated once for each algorithm.

mod show;
mod simulate;
mod summary;

use std::path::Path;
use std::rc::Rc;

use polars::prelude::DataFrame;
use rapier3d::math::Pose;
use serde::{Deserialize, Serialize};

use self::simulate::StepRow;
use super::{Error, Experiment, Measured};
use crate::algorithms::Algorithms;
use crate::claims::Tables;
use crate::config::{not_negative, positive};
use crate::job::Job;
use crate::lab::{Body, Lab, Ready};
use crate::page::Block;

/// What falls, and how.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Settings {
    /// A name in `models.toml` or the path of a mesh.
    pub(crate) model: String,
    /// Metres a unit of the model is long.
    pub(crate) scale: f64,
    mass_kg: f32,
    friction: f32,
    restitution: f32,
    /// A box.
    pub(super) ground_extents_m: [f64; 3],
    gravity_m_s2: f32,
    /// Of the centre of mass above the ground.
    drop_height_m: f32,
    /// How far ahead contacts are found, for all algorithms.
    pub(super) prediction_m: f32,
    duration_s: f64,
    /// What counts, from and to.
    measured_s: [f64; 2],
    /// A case each.
    pub(super) frequencies_hz: Vec<u32>,
    /// Random start orientations, and how many of them in a quick run.
    orientations: u32,
    quick_orientations: u32,
    seed: u64,
    pub(super) algorithms: Vec<String>,
    /// What ratios refer to.
    reference: Option<String>,
    show: Vec<Show>,
    #[serde(default)]
    paper_value: Vec<PaperValue>,
}

/// What tables and figures show.
#[derive(Clone, Copy, Debug, Deserialize, Eq, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
enum Show {
    /// Times of queries, a row an algorithm, with the curves.
    QueryTimes,
    /// Linear velocity over steps.
    LinearVelocity,
    /// Kinetic energy over steps.
    KineticEnergy,
    /// How evenly it rolls.
    Spin,
    /// Whether the body is held, by frequency.
    Frequencies,
}

/// A mean time of a query the paper prints.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct PaperValue {
    algorithm: String,
    query_us: f64,
    /// Where it stands.
    source: String,
}

impl Settings {
    fn case(frequency: u32) -> String {
        format!("{frequency}hz")
    }

    /// How many start orientations there are.
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

    /// The first step that counts and the one after the last.
    fn measured_steps(&self, frequency: u32) -> [u32; 2] {
        self.measured_s
            .map(|s| (s * f64::from(frequency)).round() as u32)
    }

    /// Another body than the file says.
    pub(crate) fn set_model(&mut self, model: &str, scale: Option<f64>) {
        self.model = model.into();
        self.scale = scale.unwrap_or(self.scale);
    }

    /// The body, and an algorithm made ready for it and the ground.
    pub(super) fn ready(
        &self,
        lab: &Lab,
        algorithm: &str,
    ) -> Result<(Rc<Body>, Rc<Ready>), String> {
        let body = lab.body(&self.model, self.scale)?;
        let ready = lab.on_box(algorithm, &body, self.ground_extents_m)?;
        Ok((body, ready))
    }

    /// The time between two steps at the first frequency in seconds.
    pub(super) fn step_s(&self) -> f64 {
        1.0 / f64::from(self.frequencies_hz[0])
    }

    /// The poses the first algorithm is asked about at the first frequency: one a step, the upper
    /// side of the ground being at height 0.
    pub(super) fn trace(&self, lab: &Lab, seed: u32) -> Result<Vec<Pose>, String> {
        let (body, ready) = self.ready(lab, &self.algorithms[0])?;
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
                return Err(format!("`{name}` is none of drop.algorithms"));
            }
        }
        Ok(())
    }

    fn algorithms(&self) -> Vec<&str> {
        self.algorithms.iter().map(String::as_str).collect()
    }

    fn jobs(&self, quick: bool) -> Vec<Job> {
        let seeds = self.seeds(quick);
        let mut jobs = Vec::new();
        for seed in 0..seeds {
            for &frequency in &self.frequencies_hz {
                jobs.extend(Job::of_each(&self.algorithms, Self::case(frequency), seed));
            }
        }
        jobs
    }

    fn settings(&self) -> Result<String, Error> {
        let of_jobs = Self {
            frequencies_hz: Vec::new(),
            orientations: 0,
            quick_orientations: 0,
            measured_s: [0.0; 2],
            algorithms: Vec::new(),
            reference: None,
            show: Vec::new(),
            paper_value: Vec::new(),
            ..self.clone()
        };
        Ok(serde_json::to_string(&of_jobs)?)
    }

    fn identity(&self, lab: &Lab) -> Result<String, String> {
        Ok(lab.body(&self.model, self.scale)?.identity.clone())
    }

    fn run(&self, job: &Job, lab: &Lab) -> Result<Measured, String> {
        let (body, ready) = self.ready(lab, &job.algorithm)?;
        let prepared = ready.prepared()?;
        let frequency = self
            .frequencies_hz
            .iter()
            .find(|f| Self::case(**f) == job.case);
        let frequency = *frequency.ok_or_else(|| format!("no case `{}`", job.case))?;
        let rows = self.simulate(&body, prepared, frequency, job.seed)?;
        Measured::of(&rows, &ready.preparation)
    }

    fn summarize(&self, rows: &DataFrame) -> Result<Tables, Error> {
        summary::summarize(self, rows)
    }

    fn present(
        &self,
        tables: &Tables,
        algorithms: &Algorithms,
        folder: &Path,
    ) -> Result<Vec<Block>, Error> {
        show::present(self, tables, algorithms, folder)
    }
}
