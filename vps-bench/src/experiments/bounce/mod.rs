//! A ball is dropped and bounces (section 4.1).

mod exact;
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
use exact::ExactBounce;

/// The ball, and how it is dropped.
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
    /// Height of the centre above the ground.
    drop_height_m: f64,
    frequency_hz: u32,
    duration_s: f64,
    /// Every combination with a prediction distance is a case.
    restitutions: Vec<f64>,
    /// Prediction distances of contacts; the first is drawn.
    predictions_m: Vec<f64>,
    /// Number of random start orientations, and in a quick run; the first is drawn.
    orientations: u32,
    quick_orientations: u32,
    seed: u64,
    algorithms: Vec<String>,
    #[serde(default)]
    paper_value: Vec<PaperValue>,
}

/// A cell of Table 1.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct PaperValue {
    algorithm: String,
    restitution: f64,
    penetration_mm: f64,
}

/// The parameters of a case.
#[derive(Clone, Copy, Debug)]
struct Case {
    restitution: f64,
    prediction_m: f64,
}

impl Case {
    fn name(self) -> String {
        let ahead_mm = self.prediction_m * 1e3;
        format!("c{}_ahead{}mm", self.restitution, ahead_mm.round())
    }
}

impl Settings {
    /// All cases; those that are drawn come first.
    fn cases(&self) -> impl Iterator<Item = Case> {
        self.predictions_m.iter().flat_map(|&prediction_m| {
            self.restitutions.iter().map(move |&restitution| Case {
                restitution,
                prediction_m,
            })
        })
    }

    fn drawn_cases(&self) -> impl Iterator<Item = Case> {
        self.cases().take(self.restitutions.len())
    }

    fn steps(&self) -> u32 {
        (self.duration_s * f64::from(self.frequency_hz)).round() as u32
    }

    fn exact(&self, restitution: f64) -> ExactBounce {
        ExactBounce {
            radius_m: self.radius_m,
            drop_height_m: self.drop_height_m,
            gravity_m_s2: self.gravity_m_s2,
            restitution,
        }
    }
}

impl Experiment for Settings {
    fn check(&self) -> Result<(), String> {
        positive("bounce.radius_m", self.radius_m)?;
        positive("bounce.mass_kg", self.mass_kg)?;
        positive("bounce.gravity_m_s2", self.gravity_m_s2)?;
        positive("bounce.frequency_hz", self.frequency_hz.into())?;
        positive("bounce.duration_s", self.duration_s)?;
        not_negative("bounce.friction", self.friction)?;
        for extent in self.ground_extents_m {
            positive("bounce.ground_extents_m", extent)?;
        }
        if !(self.drop_height_m > self.radius_m && self.drop_height_m.is_finite()) {
            return Err("bounce.drop_height_m must be above bounce.radius_m".into());
        }
        if self.subdivisions > 8 {
            return Err("bounce.subdivisions must be 8 or less".into());
        }
        for &restitution in &self.restitutions {
            if !(0.0..1.0).contains(&restitution) {
                return Err("bounce.restitutions must be from 0 to below 1".into());
            }
        }
        for &prediction in &self.predictions_m {
            not_negative("bounce.predictions_m", prediction)?;
        }
        if self.orientations == 0 || self.quick_orientations == 0 {
            return Err("bounce.orientations, bounce.quick_orientations must be 1 or more".into());
        }
        if [
            self.algorithms.len(),
            self.restitutions.len(),
            self.predictions_m.len(),
        ]
        .contains(&0)
        {
            return Err(
                "bounce.algorithms, restitutions and predictions_m must not be empty".into(),
            );
        }
        Ok(())
    }

    fn algorithms(&self) -> Vec<&str> {
        self.algorithms.iter().map(String::as_str).collect()
    }

    fn jobs(&self, quick: bool) -> Vec<Job> {
        let seeds = if quick {
            self.quick_orientations
        } else {
            self.orientations
        };
        let cases: Vec<_> = self.cases().map(Case::name).collect();
        Job::of_all(seeds, &cases, &self.algorithms)
    }

    fn planning_keys(&self) -> &'static [&'static str] {
        &[
            "restitutions",
            "predictions_m",
            "orientations",
            "quick_orientations",
            "algorithms",
            "paper_value",
        ]
    }

    fn run(&self, job: &Job, context: &Context) -> Result<Measurement, String> {
        let ball = (self.radius_m, self.subdivisions);
        let ready = context.prepare_ball_on_box(&job.algorithm, ball, self.ground_extents_m)?;
        let prepared = ready.prepared()?;
        let case = job.find_case(self.cases(), |case| case.name())?;
        let rows = self.simulate(prepared, case, job.seed)?;
        Measurement::of(&rows, &ready.preparation)
    }

    fn summarize(&self, rows: &DataFrame) -> Result<Tables, Error> {
        summary::summarize(self, rows)
    }

    fn present(&self, page: &Page<'_>) -> Result<Vec<Block>, Error> {
        present::present(self, page)
    }
}
