//! The trait of all kinds of experiments.

use std::path::Path;

use polars::prelude::DataFrame;
use serde::Serialize;

use crate::data::tables::Tables;
use crate::error::Error;
use crate::harness::archive::Rows;
use crate::harness::context::Context;
use crate::harness::job::Job;
use crate::harness::prepare::Preparation;
use crate::report::document::Block;
use crate::report::page::Page;

/// The result of a job.
pub(crate) struct Measurement {
    pub(crate) rows: Rows,
    pub(crate) preparation: Preparation,
}

impl Measurement {
    /// Rows, and how the algorithm was prepared.
    pub(crate) fn of<R: Serialize>(rows: &[R], preparation: &Preparation) -> Result<Self, String> {
        Ok(Self {
            rows: Rows::of(rows)?,
            preparation: preparation.clone(),
        })
    }
}

/// A kind of experiment with its settings.
pub(crate) trait Experiment {
    /// Checks the settings; an error names the key.
    fn check(&self) -> Result<(), String>;

    /// The model and the length of its unit in metres, if the kind has one that can be replaced.
    fn model_mut(&mut self) -> Option<(&mut String, &mut f64)> {
        None
    }

    /// Replaces the model, and its scale if one is given; false if the kind has no model to be
    /// replaced.
    fn replace_model(&mut self, model: &str, scale: Option<f64>) -> bool {
        let Some((its_model, its_scale)) = self.model_mut() else {
            return false;
        };
        *its_model = model.into();
        *its_scale = scale.unwrap_or(*its_scale);
        true
    }

    /// The model and the length of its unit in metres, if a report states how to run another one.
    fn model(&self) -> Option<(&str, f64)> {
        None
    }

    /// Names of the algorithms in `algorithms.toml` that take part, in the order of tables.
    fn algorithms(&self) -> Vec<&str> {
        Vec::new()
    }

    /// All jobs in the order they are run: seed by seed, so that a slow minute of the machine
    /// affects all algorithms. `quick` asks for the least that shows that everything works.
    fn jobs(&self, quick: bool) -> Vec<Job>;

    /// Keys of the settings that no job depends on: they only decide how many jobs there are, or
    /// how they are presented. A dot leads into a table, as in `fall.show`. All other settings
    /// identify a job.
    fn planning_keys(&self) -> &'static [&'static str] {
        &[]
    }

    /// Inputs of the jobs beside the settings, such as the bytes of a model.
    ///
    /// # Errors
    /// When they cannot be had.
    fn identity(&self, _context: &Context) -> Result<String, String> {
        Ok(String::new())
    }

    /// Runs a job.
    ///
    /// # Errors
    /// When it cannot be run, in one line: the harness keeps it as the job's status and goes on.
    fn run(&self, job: &Job, context: &Context) -> Result<Measurement, String>;

    /// Sums up the rows of all jobs (columns `case`, `algorithm`, `seed` and those of the rows) in
    /// small tables, which are kept.
    fn summarize(&self, rows: &DataFrame) -> Result<Tables, Error>;

    /// Draws into `folder` the pictures that need more than the tables. It is called when all jobs
    /// are done and their tables kept; a report shows the pictures that are there.
    ///
    /// # Errors
    /// When something cannot be drawn or written.
    fn draw(&self, _context: &Context, _folder: &Path) -> Result<(), Error> {
        Ok(())
    }

    /// Tables, figures and text of a page of the report, from the small tables alone.
    fn present(&self, page: &Page<'_>) -> Result<Vec<Block>, Error>;
}
