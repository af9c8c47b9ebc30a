//! Balls stacked on each other (section 4.1, last paragraph): how long they stand.

mod present;
mod simulate;
mod summary;

use polars::prelude::DataFrame;
use serde::{Deserialize, Serialize};

use crate::config::validate::{not_negative, positive};
use crate::data::tables::Tables;
use crate::error::Error;
use crate::experiments::experiment::{Experiment, Measurement};
use crate::harness::context::Context;
use crate::harness::job::Job;
use crate::report::document::Block;
use crate::report::page::Page;

/// The balls, and how they are stacked.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Settings {
    radius_m: f64,
    /// Subdivisions of the icosahedron whose mesh VPS samples.
    subdivisions: u32,
    mass_kg: f64,
    friction: f64,
    /// Edge lengths of the box.
    ground_extents_m: [f64; 3],
    gravity_m_s2: f64,
    frequency_hz: u32,
    /// Prediction distance of contacts, for all algorithms.
    prediction_m: f64,
    /// Time limit of a simulation.
    duration_s: f64,
    /// Largest distance of a centre from the vertical, drawn for each ball.
    offset_m: f64,
    /// One case for each.
    balls: Vec<u32>,
    /// Number of stacks with random offsets and orientations, and in a quick run.
    stacks: u32,
    quick_stacks: u32,
    seed: u64,
    algorithms: Vec<String>,
}

impl Settings {
    fn case(balls: u32) -> String {
        format!("{balls}balls")
    }

    fn steps(&self) -> u32 {
        (self.duration_s * f64::from(self.frequency_hz)).round() as u32
    }
}

impl Experiment for Settings {
    fn check(&self) -> Result<(), String> {
        positive("stack.radius_m", self.radius_m)?;
        positive("stack.mass_kg", self.mass_kg)?;
        positive("stack.gravity_m_s2", self.gravity_m_s2)?;
        positive("stack.frequency_hz", self.frequency_hz.into())?;
        positive("stack.duration_s", self.duration_s)?;
        not_negative("stack.friction", self.friction)?;
        not_negative("stack.prediction_m", self.prediction_m)?;
        not_negative("stack.offset_m", self.offset_m)?;
        for extent in self.ground_extents_m {
            positive("stack.ground_extents_m", extent)?;
        }
        if self.subdivisions > 8 {
            return Err("stack.subdivisions must be 8 or less".into());
        }
        if self.balls.iter().any(|&balls| balls < 2) {
            return Err("stack.balls must be 2 or more".into());
        }
        if self.stacks == 0 || self.quick_stacks == 0 {
            return Err("stack.stacks and stack.quick_stacks must be 1 or more".into());
        }
        if self.algorithms.is_empty() || self.balls.is_empty() {
            return Err("stack.algorithms and stack.balls must not be empty".into());
        }
        Ok(())
    }

    fn algorithms(&self) -> Vec<&str> {
        self.algorithms.iter().map(String::as_str).collect()
    }

    fn jobs(&self, quick: bool) -> Vec<Job> {
        let seeds = if quick {
            self.quick_stacks
        } else {
            self.stacks
        };
        let cases: Vec<_> = self.balls.iter().map(|n| Self::case(*n)).collect();
        Job::of_all(seeds, &cases, &self.algorithms)
    }

    fn planning_keys(&self) -> &'static [&'static str] {
        &["balls", "stacks", "quick_stacks", "algorithms"]
    }

    fn run(&self, job: &Job, context: &Context) -> Result<Measurement, String> {
        let ball = (self.radius_m, self.subdivisions);
        let ready = context.prepare_ball_on_box(&job.algorithm, ball, self.ground_extents_m)?;
        let prepared = ready.prepared()?;
        let balls = job.find_case(self.balls.iter().copied(), |n| Self::case(*n))?;
        let row = self.simulate(prepared, balls, job.seed)?;
        Measurement::of(&[row], &ready.preparation)
    }

    fn summarize(&self, rows: &DataFrame) -> Result<Tables, Error> {
        summary::summarize(self, rows)
    }

    fn present(&self, page: &Page<'_>) -> Result<Vec<Block>, Error> {
        present::present(self, page)
    }
}
