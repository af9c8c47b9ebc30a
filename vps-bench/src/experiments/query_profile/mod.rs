//! Instructions and cache misses of queries, counted by callgrind.
//!
//! A job starts this program twice under valgrind, to execute the same queries once and several times
//! more. The difference is that of the queries alone, in caches that hold what they need.

mod callgrind;
pub(crate) mod target;

use polars::prelude::DataFrame;
use serde::{Deserialize, Serialize};
use vps_core::Work;

use self::callgrind::Counts;
use self::target::Target;
use crate::config::validate::positive;
use crate::data::dataframe::{self, rows};
use crate::data::number_format::fixed;
use crate::data::tables::Tables;
use crate::error::Error;
use crate::experiments::experiment::{Experiment, Measurement};
use crate::experiments::shared::query_field::{QueryField, shell, voxelmap_of_box};
use crate::experiments::shared::tree_query::TreeQuery;
use crate::harness::context::Context;
use crate::harness::job::Job;
use crate::harness::prepare::Preparation;
use crate::report::document::{Block, Table};
use crate::report::page::Page;

/// The shell, the boxes it is put into, and its poses.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Settings {
    /// A name in `models.toml` or the path of a mesh.
    model: String,
    /// Length of a unit of the model in metres.
    scale: f64,
    /// The algorithm of the method `vps` whose shell is asked, and whose ground has the voxels of all
    /// voxelmaps.
    shell: String,
    /// Edge lengths of the ground, and of a box that holds the body as a whole.
    ground_extents_m: [f64; 3],
    around_extents_m: [f64; 3],
    /// Orientations of the body.
    poses: u32,
    /// Depth of the lowest point in the ground.
    depth_m: f32,
    /// Prediction distance on the ground; none in the box.
    prediction_m: f32,
    /// How many more times the second run executes every query.
    repeats: u32,
}

/// A query that is counted: its case, its name in tables, and whether the body is inside the box.
struct Counted {
    case: &'static str,
    name: &'static str,
    query: TreeQuery,
    is_inside: bool,
}

const COUNTED: [Counted; 4] = [
    Counted {
        case: "deepest",
        name: "deepest",
        query: TreeQuery::Deepest,
        is_inside: false,
    },
    Counted {
        case: "manifold",
        name: "manifold of 4",
        query: TreeQuery::Manifold,
        is_inside: false,
    },
    Counted {
        case: "wrench",
        name: "force and torque",
        query: TreeQuery::Wrench,
        is_inside: false,
    },
    Counted {
        case: "wrench_inside",
        name: "force and torque, all inside",
        query: TreeQuery::Wrench,
        is_inside: true,
    },
];

impl Counted {
    /// The fields it is executed in: of an exact box the force inside is of no interest.
    fn fields(&self) -> &'static [QueryField] {
        &QueryField::ALL[usize::from(self.is_inside)..]
    }
}

/// Counts of a query: means over the poses.
#[derive(Clone, Debug, Serialize)]
struct ProfileRow {
    query: String,
    field: String,
    spheres: f64,
    points: f64,
    instructions: f64,
    first_level_misses: f64,
    last_level_misses: f64,
}

const COLUMNS: [&str; 5] = [
    "spheres",
    "points",
    "instructions",
    "first_level_misses",
    "last_level_misses",
];

impl Settings {
    fn target(
        &self,
        counted: &Counted,
        field: QueryField,
        context: &Context,
    ) -> Result<Target, String> {
        let body = context.body(&self.model, self.scale)?;
        let extents_m = if counted.is_inside {
            self.around_extents_m
        } else {
            self.ground_extents_m
        };
        let map = match field.density() {
            Some(density) => Some(voxelmap_of_box(context, &self.shell, extents_m, density)?.file),
            None => None,
        };
        Ok(Target {
            shell: shell(context, &self.shell, &body.mesh)?.file,
            map,
            extents_m,
            query: counted.query,
            is_inside: counted.is_inside,
            poses: self.poses,
            depth_m: self.depth_m,
            prediction_m: if counted.is_inside {
                0.0
            } else {
                self.prediction_m
            },
        })
    }

    fn profile(
        &self,
        counted: &Counted,
        field: QueryField,
        context: &Context,
    ) -> Result<ProfileRow, String> {
        let target = self.target(counted, field, context)?;
        let [less, more] = [1, 1 + self.repeats].map(|times| callgrind::count(&target, times));
        let per_query = |of: fn(&Counts) -> u64, less: &Counts, more: &Counts| {
            of(more).saturating_sub(of(less)) as f64 / f64::from(self.repeats * self.poses)
        };
        let (less, more) = (less?, more?);
        let work = Work::default();
        target.execute(1, Some(&work))?;
        let per_pose = |count: u64| count as f64 / f64::from(self.poses);
        Ok(ProfileRow {
            query: counted.name.into(),
            field: field.name().into(),
            spheres: per_pose(work.spheres()).round(),
            points: per_pose(work.points()).round(),
            instructions: per_query(Counts::instructions, &less, &more).round(),
            first_level_misses: per_query(Counts::first_level_misses, &less, &more).round(),
            last_level_misses: per_query(Counts::last_level_misses, &less, &more).round(),
        })
    }
}

impl Experiment for Settings {
    fn check(&self) -> Result<(), String> {
        positive("query_profile.scale", self.scale)?;
        positive("query_profile.poses", self.poses.into())?;
        positive("query_profile.repeats", self.repeats.into())?;
        for extent in [self.ground_extents_m, self.around_extents_m].concat() {
            positive(
                "query_profile.ground_extents_m and around_extents_m",
                extent,
            )?;
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
        vec![&self.shell]
    }

    fn jobs(&self, quick: bool) -> Vec<Job> {
        let counted = &COUNTED[..if quick { 1 } else { COUNTED.len() }];
        let of_query = |counted: &Counted| {
            let fields = counted.fields().iter();
            let jobs = fields.map(|field| Job::new(counted.case, field.name(), 0));
            jobs.collect::<Vec<_>>()
        };
        counted.iter().flat_map(of_query).collect()
    }

    fn identity(&self, context: &Context) -> Result<String, String> {
        let shell = serde_json::to_string(context.algorithms.vps(&self.shell)?);
        let shell = shell.map_err(|e| e.to_string())?;
        let body = context.body(&self.model, self.scale)?;
        Ok(format!("{} {shell}", body.identity))
    }

    fn run(&self, job: &Job, context: &Context) -> Result<Measurement, String> {
        let counted = job.find_case(&COUNTED, |counted| counted.case)?;
        let mut fields = counted.fields().iter();
        let field = fields.find(|field| field.name() == job.algorithm);
        let row = self.profile(counted, *field.ok_or("no such field")?, context)?;
        Measurement::of(&[row], &Preparation::default())
    }

    /// `profile`: a row for each query and field.
    fn summarize(&self, records: &DataFrame) -> Result<Tables, Error> {
        let profile = rows(records).map(|row| {
            let number = |column| row.number(column).unwrap_or(f64::NAN);
            let [
                spheres,
                points,
                instructions,
                first_level_misses,
                last_level_misses,
            ] = COLUMNS.map(number);
            ProfileRow {
                query: row.text("query"),
                field: row.text("field"),
                spheres,
                points,
                instructions,
                first_level_misses,
                last_level_misses,
            }
        });
        Ok(Tables::from([("profile".into(), dataframe::of(profile)?)]))
    }

    fn present(&self, page: &Page<'_>) -> Result<Vec<Block>, Error> {
        let mut table = Table::new(
            "Counts of a query, on average; a batch is four spheres or points that are tested together",
            &[
                "query",
                "field",
                "spheres",
                "points",
                "instructions",
                "first-level misses",
                "last-level misses",
                "instructions a batch",
            ],
        );
        for row in rows(page.table("profile")?) {
            let [spheres, points, instructions, ..] = COLUMNS.map(|column| row.number(column));
            let tested = spheres
                .zip(points)
                .map(|(spheres, points)| spheres + points);
            let a_batch = instructions.zip(tested).map(|(n, tested)| 4.0 * n / tested);
            let counts = COLUMNS.map(|column| fixed(row.number(column), 0));
            let names = [row.text("query"), row.text("field")];
            table.push(names.into_iter().chain(counts).chain([fixed(a_batch, 0)]));
        }
        Ok(vec![Block::Table(table)])
    }
}
