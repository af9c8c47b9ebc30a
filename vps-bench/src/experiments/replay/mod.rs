//! Poses of one fall, put through every algorithm: all answer the same questions.
//!
//! Where each algorithm simulates a body of its own, its times contain the behaviour it causes, and
//! what it says of penetration cannot be compared with what others say. Here the fall is recorded
//! once a seed, and the algorithms are asked pose by pose.

mod answer;
mod show;
mod summary;

use std::path::Path;
use std::time::Instant;

use polars::prelude::DataFrame;
use rapier3d::math::{Pose, Vector};
use serde::{Deserialize, Serialize};
use vps_compare::{Contacts, Prepared};

use super::{Error, Experiment, Measured, drop};
use crate::algorithms::Algorithms;
use crate::claims::Tables;
use crate::config::{not_negative, positive};
use crate::job::Job;
use crate::lab::{Body, Lab};
use crate::page::Block;

/// Which fall is recorded, and who is asked about it.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Settings {
    /// The fall: of the first of its algorithms at the first of its frequencies, an orientation a
    /// seed.
    fall: drop::Settings,
    algorithms: Vec<String>,
    /// How often the whole trace is put through an algorithm after the warm-up, which is one more;
    /// the least time of each pose counts.
    passes: u32,
    /// From which penetration on not to find a touch is to miss it, and from which distance on to
    /// find one is wrong.
    tolerance_m: f64,
}

/// What an algorithm said about one pose.
#[derive(Clone, Debug, Serialize)]
struct PoseRow {
    step: u32,
    /// The least of all passes.
    query_us: f64,
    contacts: usize,
    /// Of the deepest contact; empty without one.
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
    /// Another body than the file says.
    pub(crate) fn set_model(&mut self, model: &str, scale: Option<f64>) {
        self.fall.set_model(model, scale);
    }

    /// Puts the poses of a trace near the ground through an algorithm: those an engine would ask
    /// about.
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
        // The first pass is the warm-up. Within a pass contacts are kept from pose to pose; asking
        // about a pose twice in a row would find what was kept of that very pose.
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
                (row.contacts, row.penetration_m) = contacts.summary();
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

    fn algorithms(&self) -> Vec<&str> {
        let recorder = self.fall.algorithms.iter().take(1);
        let all = self.algorithms.iter().chain(recorder);
        all.map(String::as_str).collect()
    }

    fn jobs(&self, quick: bool) -> Vec<Job> {
        let seeds = self.fall.seeds(quick);
        let of_seed = |seed| Job::of_each(&self.algorithms, "fall".into(), seed);
        (0..seeds).flat_map(of_seed).collect()
    }

    fn settings(&self) -> Result<String, Error> {
        let frequency = self.fall.frequencies_hz[0];
        let fall = self.fall.settings()?;
        Ok(format!("{fall} {frequency} {}", self.passes))
    }

    fn identity(&self, lab: &Lab) -> Result<String, String> {
        let recorder = lab.algorithms.get(&self.fall.algorithms[0])?;
        let method = serde_json::to_string(&recorder.method).map_err(|e| e.to_string())?;
        Ok(format!("{} {method}", self.fall.identity(lab)?))
    }

    fn run(&self, job: &Job, lab: &Lab) -> Result<Measured, String> {
        let trace = self.fall.trace(lab, job.seed)?;
        let (body, ready) = self.fall.ready(lab, &job.algorithm)?;
        let prepared = ready.prepared()?;
        let rows = self.replay(&trace, &body, prepared)?;
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
