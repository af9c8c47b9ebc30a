//! Balls stacked on each other (section 4.1, last paragraph): how long they stand.

mod show;
mod simulate;
mod summary;

use std::path::Path;

use polars::prelude::DataFrame;
use serde::{Deserialize, Serialize};

use super::{Error, Experiment, Measured};
use crate::algorithms::Algorithms;
use crate::claims::Tables;
use crate::config::{not_negative, positive};
use crate::job::Job;
use crate::lab::Lab;
use crate::page::Block;

/// The balls, and how they are stacked.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Settings {
    radius_m: f64,
    /// The mesh VPS samples is an icosahedron divided so many times.
    subdivisions: u32,
    mass_kg: f64,
    friction: f64,
    /// A box.
    ground_extents_m: [f64; 3],
    gravity_m_s2: f64,
    frequency_hz: u32,
    /// How far ahead contacts are found, for all algorithms.
    prediction_m: f64,
    /// A stack that stands for so long is left alone.
    duration_s: f64,
    /// How far centres are from the vertical at most, each on its own.
    offset_m: f64,
    /// A case each.
    balls: Vec<u32>,
    /// Random offsets and orientations, and how many of them in a quick run.
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
        let mut jobs = Vec::new();
        for seed in 0..seeds {
            for &balls in &self.balls {
                jobs.extend(Job::of_each(&self.algorithms, Self::case(balls), seed));
            }
        }
        jobs
    }

    fn settings(&self) -> Result<String, Error> {
        let of_jobs = Self {
            balls: Vec::new(),
            stacks: 0,
            quick_stacks: 0,
            algorithms: Vec::new(),
            ..self.clone()
        };
        Ok(serde_json::to_string(&of_jobs)?)
    }

    fn identity(&self, _: &Lab) -> Result<String, String> {
        Ok(String::new())
    }

    fn run(&self, job: &Job, lab: &Lab) -> Result<Measured, String> {
        let ball = (self.radius_m, self.subdivisions);
        let ready = lab.ball_on_box(&job.algorithm, ball, self.ground_extents_m)?;
        let prepared = ready.prepared()?;
        let mut cases = self.balls.iter();
        let balls = cases.find(|balls| Self::case(**balls) == job.case);
        let balls = *balls.ok_or_else(|| format!("no case `{}`", job.case))?;
        let row = self.simulate(prepared, balls, job.seed)?;
        Measured::of(&[row], &ready.preparation)
    }

    fn summarize(&self, rows: &DataFrame) -> Result<Tables, Error> {
        summary::summarize(self, rows)
    }

    fn present(
        &self,
        tables: &Tables,
        algorithms: &Algorithms,
        _: &Path,
    ) -> Result<Vec<Block>, Error> {
        show::present(self, tables, algorithms)
    }
}
