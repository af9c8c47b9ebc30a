//! The time-critical query (section 5, future work): its error when the budget ends, and how well
//! it keeps a deadline.

mod measure;
mod present;
mod summary;

use std::time::Duration;

use polars::prelude::DataFrame;
use serde::{Deserialize, Serialize};
use vps_rapier::{Sampling, VpsShape};

use crate::config::validate::{not_negative, positive};
use crate::data::tables::Tables;
use crate::error::Error;
use crate::experiments::experiment::{Experiment, Measurement};
use crate::harness::context::Context;
use crate::harness::job::Job;
use crate::report::document::Block;
use crate::report::page::Page;
use measure::{Poses, measure};

/// Body, poses, budgets and deadlines.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Settings {
    /// A name in `models.toml` or the path of a mesh.
    model: String,
    /// Length of a unit of the model in metres.
    scale: f64,
    /// Edge lengths of the box.
    ground_extents_m: [f64; 3],
    /// Depth of the body, from and to; negative above the ground.
    depth_m: [f64; 2],
    /// Largest distance from the centre of the ground, along either side.
    aside_m: f64,
    /// Numbers of points that may be tested, one case for each.
    budget_points: Vec<u64>,
    /// Deadlines of the query, one case for each.
    deadline_us: Vec<u64>,
    /// Time before the deadline at which the query is told to end.
    reserve_us: u64,
    /// Number of continuation callbacks between two readings of the clock.
    clock_every: u32,
    poses_per_batch: u32,
    /// Batches of poses for a deadline, and for a number of points.
    deadline_batches: u32,
    budget_batches: u32,
    quick_batches: u32,
    seed: u64,
    /// Algorithms of the method `vps`, with a voxelmap of the ground.
    algorithms: Vec<String>,
}

/// The limit that ends a query.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
enum Limit {
    Points(u64),
    Deadline(Duration),
    /// No limit: the query is complete.
    None,
}

impl Limit {
    fn case(self) -> String {
        match self {
            Self::Points(points) => format!("{points}points"),
            Self::Deadline(time) => format!("{}us", time.as_micros()),
            Self::None => "unlimited".into(),
        }
    }
}

impl Settings {
    /// The time after which a query with a deadline is told to end.
    fn stop_after(&self, deadline: Duration) -> Duration {
        deadline.saturating_sub(Duration::from_micros(self.reserve_us))
    }

    fn budgets(&self) -> impl Iterator<Item = Limit> {
        self.budget_points.iter().copied().map(Limit::Points)
    }

    fn deadlines(&self) -> impl Iterator<Item = Limit> {
        let times = self.deadline_us.iter().copied();
        times.map(Duration::from_micros).map(Limit::Deadline)
    }

    fn limits(&self) -> impl Iterator<Item = Limit> {
        self.budgets().chain([Limit::None]).chain(self.deadlines())
    }
}

impl Experiment for Settings {
    fn check(&self) -> Result<(), String> {
        positive("time_critical.scale", self.scale)?;
        not_negative("time_critical.aside_m", self.aside_m)?;
        for extent in self.ground_extents_m {
            positive("time_critical.ground_extents_m", extent)?;
        }
        let [from, to] = self.depth_m;
        if !(from < to && from.is_finite() && to.is_finite()) {
            return Err("time_critical.depth_m must grow".into());
        }
        for &points in &self.budget_points {
            positive("time_critical.budget_points", points as f64)?;
        }
        for &deadline in &self.deadline_us {
            if deadline <= self.reserve_us {
                return Err(
                    "time_critical.deadline_us must be above time_critical.reserve_us".into(),
                );
            }
        }
        let counts = [
            self.clock_every,
            self.poses_per_batch,
            self.deadline_batches,
            self.budget_batches,
            self.quick_batches,
        ];
        if counts.contains(&0) {
            return Err(
                "time_critical.clock_every, poses_per_batch, deadline_batches, budget_batches and \
                 quick_batches must be 1 or more"
                    .into(),
            );
        }
        if self.algorithms.is_empty() {
            return Err("time_critical.algorithms must not be empty".into());
        }
        Ok(())
    }

    fn algorithms(&self) -> Vec<&str> {
        self.algorithms.iter().map(String::as_str).collect()
    }

    fn jobs(&self, quick: bool) -> Vec<Job> {
        let batches = |limit| match limit {
            _ if quick => self.quick_batches,
            Limit::Deadline(_) => self.deadline_batches,
            Limit::Points(_) | Limit::None => self.budget_batches,
        };
        let mut jobs = Vec::new();
        for seed in 0..self.deadline_batches.max(self.budget_batches) {
            for limit in self.limits().filter(|limit| seed < batches(*limit)) {
                let algorithms = self.algorithms.iter();
                jobs.extend(algorithms.map(|a| Job::new(limit.case(), a, seed)));
            }
        }
        jobs
    }

    fn planning_keys(&self) -> &'static [&'static str] {
        &[
            "budget_points",
            "deadline_us",
            "deadline_batches",
            "budget_batches",
            "quick_batches",
            "algorithms",
        ]
    }

    fn identity(&self, context: &Context) -> Result<String, String> {
        Ok(context.body(&self.model, self.scale)?.identity.clone())
    }

    fn run(&self, job: &Job, context: &Context) -> Result<Measurement, String> {
        let method = context.algorithms.vps(&job.algorithm)?;
        let limit = job.find_case(self.limits(), |limit| limit.case())?;
        let body = context.body(&self.model, self.scale)?;
        let ready = context.prepare_on_box(&job.algorithm, &body, self.ground_extents_m)?;
        let prepared = ready.prepared()?;
        let shape = prepared.body.as_shape::<VpsShape>();
        let ground = prepared.ground.as_shape::<VpsShape>();
        let (Some(shape), Some(ground)) = (shape, ground) else {
            return Err("the ground needs ground_voxel_size_m".into());
        };
        let poses = Poses::of(self, &body, job.seed);
        let (tree, map) = (&shape.asset().tree, &ground.asset().voxelmap);
        let center = body.mass.center();
        let row = match method.sampling {
            Sampling::Trilinear => measure(self, limit, tree, &map.trilinear(), center, &poses),
            Sampling::Local => measure(self, limit, tree, &map.local(), center, &poses),
        };
        Measurement::of(&[row?], &ready.preparation)
    }

    fn summarize(&self, rows: &DataFrame) -> Result<Tables, Error> {
        summary::summarize(rows)
    }

    fn present(&self, page: &Page<'_>) -> Result<Vec<Block>, Error> {
        present::present(self, page)
    }
}
