//! The kinds of experiments. Each has settings in TOML, makes jobs of them, runs one job to rows,
//! sums rows up in tables, and says what the tables show.

pub(crate) mod accuracy;
pub(crate) mod bounce;
pub(crate) mod drop;
mod orientation;
mod power_law;
pub(crate) mod replay;
pub(crate) mod scaling;
pub(crate) mod stack;
pub(crate) mod structures;
pub(crate) mod time_critical;
mod world;

use std::path::Path;

use polars::prelude::DataFrame;
use serde::Serialize;

use crate::algorithms::Algorithms;
use crate::archive::Rows;
use crate::claims::Tables;
use crate::job::Job;
use crate::lab::{Lab, Preparation};
use crate::page::Block;

pub(crate) type Error = Box<dyn std::error::Error>;

/// What a job gave.
pub(crate) struct Measured {
    pub(crate) rows: Rows,
    pub(crate) preparation: Preparation,
}

impl Measured {
    /// A row each, and what the algorithm was made from.
    pub(crate) fn of<R: Serialize>(rows: &[R], preparation: &Preparation) -> Result<Self, String> {
        Ok(Self {
            rows: Rows::of(rows)?,
            preparation: preparation.clone(),
        })
    }
}

/// A kind of experiment with its settings.
pub(crate) trait Experiment {
    /// That the settings make sense; an error names the key.
    fn check(&self) -> Result<(), String>;

    /// Names of the algorithms in `algorithms.toml` that take part, in the order of tables.
    fn algorithms(&self) -> Vec<&str>;

    /// Everything to be done, in the order it is done in: seed by seed, so that a slow minute of the
    /// machine meets all algorithms. `quick` asks for the least that shows that all works.
    fn jobs(&self, quick: bool) -> Vec<Job>;

    /// The settings a job depends on, as text: not those that only decide how many jobs there are or
    /// what is shown of them.
    fn settings(&self) -> Result<String, Error>;

    /// What decides what jobs do beside the settings, such as the bytes of a model.
    ///
    /// # Errors
    /// When it cannot be had.
    fn identity(&self, lab: &Lab) -> Result<String, String>;

    /// Runs a job.
    ///
    /// # Errors
    /// When it cannot be run, in one line: the harness keeps it as the job's status and goes on.
    fn run(&self, job: &Job, lab: &Lab) -> Result<Measured, String>;

    /// Sums up the rows of all jobs (columns `case`, `algorithm`, `seed` and those of the rows) in
    /// small tables, which are kept.
    fn summarize(&self, rows: &DataFrame) -> Result<Tables, Error>;

    /// Draws into `folder` what needs more than the tables. It is called when all jobs are done and
    /// their tables kept; a report shows the pictures that are there.
    ///
    /// # Errors
    /// When something cannot be drawn or written.
    fn draw(&self, _lab: &Lab, _folder: &Path) -> Result<(), Error> {
        Ok(())
    }

    /// Tables, figures (written into `folder`) and text, from the small tables alone.
    fn present(
        &self,
        tables: &Tables,
        algorithms: &Algorithms,
        folder: &Path,
    ) -> Result<Vec<Block>, Error>;
}
