//! Replays the poses of one fall through every algorithm.
//!
//! If each algorithm simulates its own body, its times include the behaviour it causes, and
//! penetrations of different algorithms cannot be compared. Here the fall is recorded once for each
//! seed, and all algorithms are queried at the same poses.

mod answer;
mod present;
mod summary;

use std::time::Instant;

use polars::prelude::DataFrame;
use rapier3d::math::{Pose, Vector};
use serde::{Deserialize, Serialize};
use vps_compare::{Contacts, Prepared};

use crate::config::validate::{not_negative, positive};
use crate::data::tables::Tables;
use crate::error::Error;
use crate::experiments::drop;
use crate::experiments::experiment::{Experiment, Measurement};
use crate::harness::context::{Body, Context};
use crate::harness::job::Job;
use crate::report::document::Block;
use crate::report::page::Page;

/// The recorded fall, and the algorithms that are queried.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Settings {
    /// The fall, simulated by the first of its algorithms at the first of its frequencies; the seed
    /// determines the orientation.
    fall: drop::Settings,
    algorithms: Vec<String>,
    /// Passes of the whole trace after one pass to warm up; the least time of each pose counts.
    passes: u32,
    /// Penetration beyond which a touch must be found, and separation beyond which none may be.
    tolerance_m: f64,
}

/// The answer of an algorithm at one pose.
#[derive(Clone, Debug, Serialize)]
struct PoseRow {
    step: u32,
    /// The least time of all passes.
    query_us: f64,
    contacts: usize,
    /// Penetration of the deepest contact; empty without one.
    penetration_m: Option<f32>,
    true_penetration_m: f32,
    x_m: f32,
    y_m: f32,
    z_m: f32,
    qx: f32,
    qy: f32,
    qz: f32,
    qw: f32,
}

impl Settings {
    /// Queries an algorithm at the poses of a trace that are near the ground, as an engine would.
    fn replay(
        &self,
        trace: &[Pose],
        body: &Body,
        prepared: &Prepared,
    ) -> Result<Vec<PoseRow>, String> {
        let prediction = self.fall.prediction_m;
        let mut rows: Vec<_> = trace
            .iter()
            .enumerate()
            .map(|(step, pose)| PoseRow::new(step, pose, body.oracle.penetration(pose, 0.0)))
            .filter(|row| row.true_penetration_m >= -prediction)
            .collect();
        let up = Vector::new(0.0, 0.5 * self.fall.ground_extents_m[1] as f32, 0.0);
        // The first pass warms up. Within a pass contacts persist from pose to pose; two queries of
        // one pose in a row would reuse the contacts of that very pose.
        for pass in 0..=self.passes {
            let mut contacts = Contacts::default();
            let mut next = 0;
            for row in &mut rows {
                if row.step != next {
                    contacts = Contacts::default();
                }
                next = row.step + 1;
                let pose = trace[row.step as usize];
                let in_ground = Pose::from_parts(pose.translation + up, pose.rotation);
                let start = Instant::now();
                let result = prepared.query(&in_ground, prediction, &mut contacts);
                let took = start.elapsed().as_secs_f64() * 1e6;
                result.map_err(|_| "the dispatcher does not support this pair of shapes")?;
                (row.contacts, row.penetration_m) = contacts.count_and_deepest();
                if pass > 0 {
                    row.query_us = row.query_us.min(took);
                }
            }
        }
        Ok(rows)
    }
}

impl PoseRow {
    fn new(step: usize, pose: &Pose, true_penetration_m: f32) -> Self {
        let (t, q) = (pose.translation, pose.rotation);
        Self {
            step: step as u32,
            query_us: f64::INFINITY,
            contacts: 0,
            penetration_m: None,
            true_penetration_m,
            x_m: t.x,
            y_m: t.y,
            z_m: t.z,
            qx: q.x,
            qy: q.y,
            qz: q.z,
            qw: q.w,
        }
    }
}

impl Experiment for Settings {
    fn check(&self) -> Result<(), String> {
        self.fall.check()?;
        positive("replay.passes", self.passes.into())?;
        not_negative("replay.tolerance_m", self.tolerance_m)?;
        if self.algorithms.is_empty() {
            return Err("replay.algorithms must not be empty".into());
        }
        Ok(())
    }

    fn model_mut(&mut self) -> Option<(&mut String, &mut f64)> {
        self.fall.model_mut()
    }

    fn algorithms(&self) -> Vec<&str> {
        let recorder = self.fall.algorithms.iter().take(1);
        let all = self.algorithms.iter().chain(recorder);
        all.map(String::as_str).collect()
    }

    fn jobs(&self, quick: bool) -> Vec<Job> {
        Job::of_all(self.fall.seeds(quick), &["fall".into()], &self.algorithms)
    }

    fn planning_keys(&self) -> &'static [&'static str] {
        &[
            "algorithms",
            "tolerance_m",
            "fall.orientations",
            "fall.quick_orientations",
            "fall.measured_s",
            "fall.reference",
            "fall.show",
            "fall.paper_value",
        ]
    }

    fn identity(&self, context: &Context) -> Result<String, String> {
        let recorder = context.algorithms.get(&self.fall.algorithms[0])?;
        let method = serde_json::to_string(&recorder.method).map_err(|e| e.to_string())?;
        Ok(format!("{} {method}", self.fall.identity(context)?))
    }

    fn run(&self, job: &Job, context: &Context) -> Result<Measurement, String> {
        let trace = self.fall.trace(context, job.seed)?;
        let (body, ready) = self.fall.prepare(context, &job.algorithm)?;
        let prepared = ready.prepared()?;
        let rows = self.replay(&trace, &body, prepared)?;
        Measurement::of(&rows, &ready.preparation)
    }

    fn summarize(&self, rows: &DataFrame) -> Result<Tables, Error> {
        summary::summarize(self, rows)
    }

    fn present(&self, page: &Page<'_>) -> Result<Vec<Block>, Error> {
        present::present(self, page)
    }
}
