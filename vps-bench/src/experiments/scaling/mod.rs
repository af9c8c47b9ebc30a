//! How time grows with the size of the problem, one quantity at a time.

mod bodies;
mod present;
mod queries;
mod summary;

use polars::prelude::DataFrame;
use serde::{Deserialize, Serialize};

use crate::config::validate::positive;
use crate::data::tables::Tables;
use crate::error::Error;
use crate::experiments::experiment::{Experiment, Measurement};
use crate::harness::context::Context;
use crate::harness::job::Job;
use crate::harness::prepare::Preparation;
use crate::report::document::Block;
use crate::report::page::Page;

/// The quantities that grow; the others are as for the fine shell.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Settings {
    model: String,
    scale: f64,
    ground_extents_m: [f64; 3],
    ground_voxel_size_m: f64,
    /// Prediction distance of manifolds; all other queries ask for overlaps.
    prediction_m: f32,
    /// Points of the pointshell.
    points: Vec<u32>,
    /// Voxel sizes of the voxelmap a small shell is pressed into.
    voxel_sizes_m: Vec<f64>,
    /// Segments of a torus; its triangles grow with their square.
    segments: Vec<u32>,
    /// Depths of the lowest point below the ground.
    depths_m: Vec<f32>,
    /// Points, depth and voxel size of the shell where they are fixed.
    fixed_points: u32,
    fixed_depth_m: f32,
    fixed_voxel_size_m: f64,
    /// Random poses of a query, and repetitions at each; the least time of a pose counts.
    poses: u32,
    repeats: u32,
    bodies: Bodies,
    seed: u64,
}

/// Many bodies at rest.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct Bodies {
    algorithms: Vec<String>,
    counts: Vec<u32>,
    /// Between the origins of neighbours.
    spacing_m: f32,
    mass_kg: f32,
    gravity_m_s2: f32,
    frequency_hz: u32,
    /// Steps until the bodies rest, and timed steps.
    settling_steps: u32,
    timed_steps: u32,
}

/// A case, named by the quantity that grows.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
enum Case {
    Points,
    VoxelSize,
    Triangles,
    Depth,
    Bodies,
}

/// A query of a pointshell, or of a peer.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
enum QueryKind {
    Touches,
    Deepest,
    Manifold,
    Wrench,
    /// All points one by one, without the tree.
    Flat,
    /// The triangle mesh of parry, for comparison.
    Trimesh,
}

/// A timed sample.
#[derive(Clone, Debug, Serialize)]
struct TimeRow {
    /// The quantity that grows, in the unit of its case.
    size: f64,
    sample: u32,
    /// Time of a query; or of a step, divided by the number of bodies.
    time_us: f64,
    /// Points that overlap; or contacts of the engine, divided by the number of bodies.
    contacts: f64,
}

impl Case {
    const ALL: [Self; 5] = [
        Self::Points,
        Self::VoxelSize,
        Self::Triangles,
        Self::Depth,
        Self::Bodies,
    ];

    fn name(self) -> &'static str {
        match self {
            Self::Points => "points",
            Self::VoxelSize => "voxel_size",
            Self::Triangles => "triangles",
            Self::Depth => "depth",
            Self::Bodies => "bodies",
        }
    }

    /// The quantity that grows, with its unit.
    fn label(self) -> &'static str {
        match self {
            Self::Points => "points of the shell",
            Self::VoxelSize => "voxel size (mm)",
            Self::Triangles => "source triangles",
            Self::Depth => "depth (mm)",
            Self::Bodies => "bodies",
        }
    }

    fn queries(self) -> &'static [QueryKind] {
        const QUERIES: [QueryKind; 5] = [
            QueryKind::Touches,
            QueryKind::Deepest,
            QueryKind::Manifold,
            QueryKind::Wrench,
            QueryKind::Flat,
        ];
        match self {
            Self::Points | Self::Depth => &QUERIES,
            Self::VoxelSize => &[
                QueryKind::Touches,
                QueryKind::Deepest,
                QueryKind::Manifold,
                QueryKind::Wrench,
            ],
            Self::Triangles => &[
                QueryKind::Deepest,
                QueryKind::Manifold,
                QueryKind::Wrench,
                QueryKind::Trimesh,
            ],
            Self::Bodies => &[],
        }
    }
}

impl QueryKind {
    const ALL: [Self; 6] = [
        Self::Touches,
        Self::Deepest,
        Self::Manifold,
        Self::Wrench,
        Self::Flat,
        Self::Trimesh,
    ];

    fn name(self) -> &'static str {
        match self {
            Self::Touches => "touches",
            Self::Deepest => "deepest",
            Self::Manifold => "manifold",
            Self::Wrench => "wrench",
            Self::Flat => "flat",
            Self::Trimesh => "trimesh",
        }
    }

    fn label(self) -> &'static str {
        match self {
            Self::Touches => "does it touch",
            Self::Deepest => "deepest contact",
            Self::Manifold => "four contacts",
            Self::Wrench => "force and torque of all contacts",
            Self::Flat => "all points one by one",
            Self::Trimesh => "triangle mesh of parry",
        }
    }
}

impl Experiment for Settings {
    fn check(&self) -> Result<(), String> {
        positive("scaling.scale", self.scale)?;
        positive("scaling.ground_voxel_size_m", self.ground_voxel_size_m)?;
        positive("scaling.fixed_voxel_size_m", self.fixed_voxel_size_m)?;
        positive("scaling.prediction_m", self.prediction_m.into())?;
        positive("scaling.fixed_points", self.fixed_points.into())?;
        positive("scaling.poses", self.poses.into())?;
        positive("scaling.repeats", self.repeats.into())?;
        positive("scaling.bodies.spacing_m", self.bodies.spacing_m.into())?;
        positive("scaling.bodies.mass_kg", self.bodies.mass_kg.into())?;
        positive(
            "scaling.bodies.frequency_hz",
            self.bodies.frequency_hz.into(),
        )?;
        positive("scaling.bodies.timed_steps", self.bodies.timed_steps.into())?;
        let numbers = self.points.iter().chain(&self.segments);
        for &number in numbers.chain(&self.bodies.counts) {
            positive("scaling.points, segments and bodies.counts", number.into())?;
        }
        let depths = self.depths_m.iter().map(|d| f64::from(*d));
        for length in depths.chain(self.voxel_sizes_m.iter().copied()) {
            positive("scaling.depths_m and voxel_sizes_m", length)?;
        }
        Ok(())
    }

    fn algorithms(&self) -> Vec<&str> {
        self.bodies.algorithms.iter().map(String::as_str).collect()
    }

    fn jobs(&self, quick: bool) -> Vec<Job> {
        let mut jobs = Vec::new();
        for case in Case::ALL {
            let kinds = case.queries().iter().map(|kind| kind.name().to_owned());
            let algorithms = self.bodies.algorithms.iter().cloned();
            let algorithms = algorithms.filter(|_| case == Case::Bodies);
            let measured = kinds.chain(algorithms);
            jobs.extend(measured.map(|what| Job::new(case.name(), what, 0)));
        }
        if quick {
            jobs.retain(|job| job.algorithm != QueryKind::Trimesh.name());
        }
        jobs
    }

    fn identity(&self, context: &Context) -> Result<String, String> {
        Ok(context.body(&self.model, self.scale)?.identity.clone())
    }

    fn run(&self, job: &Job, context: &Context) -> Result<Measurement, String> {
        let case = job.find_case(Case::ALL, |case| case.name())?;
        let kind = QueryKind::ALL
            .into_iter()
            .find(|kind| kind.name() == job.algorithm);
        let rows = match kind {
            Some(kind) => self.times(case, kind, context)?,
            None => self.steps(&job.algorithm, context)?,
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
