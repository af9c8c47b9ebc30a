//! Times of queries by themselves, beside those of parry's shapes at the same poses: by algorithm, by
//! field, by clustering, by points of the shell and by triangles of the source mesh.
//!
//! A seed is a round. What is compared takes turns in every round, so that a slow minute of the
//! machine affects all of it, and the median of the rounds counts.

mod measure;
mod poses;
mod present;
mod query_kind;
mod summary;

use polars::prelude::DataFrame;
use serde::{Deserialize, Serialize};

use self::measure::QueryRow;
use self::poses::PoseSet;
use crate::config::validate::positive;
use crate::data::tables::Tables;
use crate::error::Error;
use crate::experiments::drop;
use crate::experiments::experiment::{Experiment, Measurement};
use crate::experiments::shared::query_field::QueryField;
use crate::harness::context::Context;
use crate::harness::job::Job;
use crate::harness::prepare::Preparation;
use crate::report::document::Block;
use crate::report::page::Page;

/// Poses, algorithms, fields and sizes.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Settings {
    /// Rounds, and in a quick run.
    rounds: u32,
    quick_rounds: u32,
    /// Time over which the poses are repeated for one measurement, at least once.
    measured_ms: u64,
    /// Algorithms that are asked for contact manifolds as an engine does.
    algorithms: Vec<String>,
    /// Those of them that ratios refer to.
    against: Vec<String>,
    /// The algorithm of the method `vps` whose shell the queries are asked of, and whose ground has
    /// the voxels of all voxelmaps.
    shell: String,
    /// The triangle mesh, whose queries take so long that a quick run leaves it out.
    trimesh: String,
    /// First steps of each fall whose poses are asked, and how many follow each other.
    first_steps: Vec<usize>,
    steps_in_a_row: usize,
    /// Edge lengths of a box that holds the body as a whole.
    around_extents_m: [f64; 3],
    /// How far the body is moved up to be apart from the ground.
    apart_m: f32,
    /// Point spacings of the shells that are compared, from coarse to fine.
    point_spacings_m: Vec<f64>,
    /// Prediction distance of their queries.
    points_prediction_m: f32,
    tori: Tori,
    /// The fall whose poses are asked, all orientations of it; its prediction distance is that of the
    /// queries.
    fall: drop::Settings,
}

/// Tori of growing numbers of triangles, in themselves.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct Tori {
    /// Detail of the meshes, from coarse to fine.
    details: Vec<u32>,
    voxel_size_m: f64,
    margin: u32,
    points: u32,
    poses: u32,
}

/// A comparison.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
enum Case {
    /// Contact manifolds as an engine asks for them, by algorithm.
    Manifolds,
    /// All queries of the shell at a set of poses, by field.
    Fields(PoseSet),
    /// Clusters and points tested, by clustering.
    Clusters,
    /// The body in itself.
    Interlocked,
    /// By number of points.
    Points,
    /// By number of source triangles.
    Triangles,
}

/// Clusterings that are compared.
const CLUSTERINGS: [&str; 2] = ["bisect", "bottom_up"];

impl Case {
    const ALL: [Self; 9] = [
        Self::Manifolds,
        Self::Fields(PoseSet::GroundAhead),
        Self::Fields(PoseSet::Ground),
        Self::Fields(PoseSet::Inside),
        Self::Fields(PoseSet::Apart),
        Self::Clusters,
        Self::Interlocked,
        Self::Points,
        Self::Triangles,
    ];

    fn name(self) -> &'static str {
        match self {
            Self::Manifolds => "manifolds",
            Self::Fields(set) => set.name(),
            Self::Clusters => "clusters",
            Self::Interlocked => "interlocked",
            Self::Points => "points",
            Self::Triangles => "triangles",
        }
    }
}

impl Settings {
    /// Names of what a case compares.
    fn compared(&self, case: Case) -> Vec<String> {
        match case {
            Case::Manifolds => self.algorithms.clone(),
            Case::Fields(_) => QueryField::ALL.map(|field| field.name().into()).into(),
            Case::Clusters => CLUSTERINGS.map(String::from).into(),
            Case::Interlocked => vec![self.shell.clone(), self.trimesh.clone()],
            Case::Points => self.point_spacings_m.iter().map(|m| spacing(*m)).collect(),
            Case::Triangles => self.tori.details.iter().map(u32::to_string).collect(),
        }
    }

    /// Whether one round is enough: numbers of clusters never differ, and triangle meshes in each
    /// other take seconds.
    fn is_measured_once(&self, case: Case, what: &str) -> bool {
        case == Case::Clusters || (case == Case::Interlocked && what == self.trimesh)
    }
}

/// The name of a point spacing.
fn spacing(spacing_m: f64) -> String {
    format!("{spacing_m}m")
}

impl Experiment for Settings {
    fn check(&self) -> Result<(), String> {
        self.fall.check()?;
        positive("queries.rounds", self.rounds.into())?;
        positive("queries.quick_rounds", self.quick_rounds.into())?;
        positive("queries.steps_in_a_row", self.steps_in_a_row as f64)?;
        positive("queries.apart_m", self.apart_m.into())?;
        positive(
            "queries.points_prediction_m",
            self.points_prediction_m.into(),
        )?;
        positive("queries.tori.voxel_size_m", self.tori.voxel_size_m)?;
        positive("queries.tori.points", self.tori.points.into())?;
        positive("queries.tori.poses", self.tori.poses.into())?;
        for extent in self.around_extents_m {
            positive("queries.around_extents_m", extent)?;
        }
        for &spacing in &self.point_spacings_m {
            positive("queries.point_spacings_m", spacing)?;
        }
        if let Some(name) = self.against.iter().find(|a| !self.algorithms.contains(a)) {
            return Err(format!(
                "queries.against: `{name}` is none of queries.algorithms"
            ));
        }
        if self.first_steps.is_empty() {
            return Err("queries.first_steps must not be empty".into());
        }
        Ok(())
    }

    fn model_mut(&mut self) -> Option<(&mut String, &mut f64)> {
        self.fall.model_mut()
    }

    fn algorithms(&self) -> Vec<&str> {
        let named = [self.shell.as_str(), &self.trimesh];
        let all = self.algorithms.iter().map(String::as_str).chain(named);
        all.chain(self.fall.algorithms()).collect()
    }

    fn jobs(&self, quick: bool) -> Vec<Job> {
        let rounds = if quick {
            self.quick_rounds
        } else {
            self.rounds
        };
        let mut jobs = Vec::new();
        for round in 0..rounds {
            for case in Case::ALL {
                let mut compared = self.compared(case);
                if quick {
                    compared.retain(|what| *what != self.trimesh);
                    if matches!(case, Case::Points | Case::Triangles) {
                        compared.truncate(2);
                    }
                }
                compared.retain(|what| round == 0 || !self.is_measured_once(case, what));
                jobs.extend(
                    compared
                        .iter()
                        .map(|what| Job::new(case.name(), what, round)),
                );
            }
        }
        jobs
    }

    fn planning_keys(&self) -> &'static [&'static str] {
        &[
            "rounds",
            "quick_rounds",
            "algorithms",
            "against",
            "point_spacings_m",
            "tori.details",
            "fall.quick_orientations",
            "fall.measured_s",
            "fall.reference",
            "fall.show",
            "fall.paper_value",
        ]
    }

    fn identity(&self, context: &Context) -> Result<String, String> {
        let faller = &context.algorithms.get(&self.fall.algorithms[0])?.method;
        let parameters = (faller, context.algorithms.vps(&self.shell)?);
        let parameters = serde_json::to_string(&parameters).map_err(|e| e.to_string())?;
        Ok(format!("{} {parameters}", self.fall.identity(context)?))
    }

    fn run(&self, job: &Job, context: &Context) -> Result<Measurement, String> {
        let case = job.find_case(Case::ALL, |case| case.name())?;
        let what = job.algorithm.as_str();
        let rows: Vec<QueryRow> = match case {
            Case::Manifolds => {
                let (_, ready) = self.fall.prepare(context, what)?;
                let row = self.manifolds(ready.prepared()?, context)?;
                return Measurement::of(&[row], &ready.preparation);
            }
            Case::Fields(set) => self.in_field(set, what, context)?,
            Case::Clusters => self.by_clustering(what, context)?,
            Case::Interlocked => vec![self.interlocked(what, context)?],
            Case::Points => self.by_spacing(what, context)?,
            Case::Triangles => self.torus_in_torus(what, context)?,
        };
        Measurement::of(&rows, &Preparation::default())
    }

    fn summarize(&self, rows: &DataFrame) -> Result<Tables, Error> {
        summary::summarize(self, rows)
    }

    fn present(&self, page: &Page<'_>) -> Result<Vec<Block>, Error> {
        present::present(self, page)
    }
}
