//! Raw records: for each job a CSV file of rows, and a JSON file that says what they are.
//!
//! The JSON file is written last: a job that has one is done. Folders of several machines are merged
//! by copying them into one.

use std::path::{Path, PathBuf};

use polars::prelude::DataFrame;
use serde::{Deserialize, Serialize};
use vps_build::{FileError, write_atomically};

use crate::environment::Environment;
use crate::frame::{Columns, FrameError};
use crate::job::Job;
use crate::lab::Preparation;

/// What is known of a job that was run.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub(crate) struct JobRecord {
    pub(crate) job: Job,
    /// SHA-256 of all that decides what the job does: the experiment, its algorithm, its model.
    pub(crate) settings: String,
    /// `ok`, or why there are no rows.
    pub(crate) status: String,
    pub(crate) run_s: f64,
    pub(crate) preparation: Preparation,
    pub(crate) environment: Environment,
}

/// Rows of a job, as a CSV file.
#[derive(Debug, Default)]
pub(crate) struct Rows(Vec<u8>);

#[derive(Debug, thiserror::Error)]
pub(crate) enum ArchiveError {
    #[error("{}: {what}", path.display())]
    Record { path: PathBuf, what: String },
    #[error(transparent)]
    Frame(#[from] FrameError),
    #[error(transparent)]
    File(#[from] FileError),
}

impl Rows {
    /// One row each; the names of fields are those of the columns.
    pub(crate) fn of<R: Serialize>(rows: &[R]) -> Result<Self, String> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        for row in rows {
            writer.serialize(row).map_err(|e| e.to_string())?;
        }
        writer.into_inner().map(Self).map_err(|e| e.to_string())
    }
}

/// The raw records of an experiment.
pub(crate) struct Archive {
    folder: PathBuf,
}

impl Archive {
    /// Those in a folder, which is made when it is needed.
    pub(crate) fn new(folder: impl Into<PathBuf>) -> Self {
        Self {
            folder: folder.into(),
        }
    }

    fn path(&self, job: &Job, extension: &str) -> PathBuf {
        self.folder.join(format!("{}.{extension}", job.id()))
    }

    /// What is known of a job; `None` if it has not been run, or by a version that kept something else.
    pub(crate) fn record(&self, job: &Job) -> Result<Option<JobRecord>, ArchiveError> {
        let path = self.path(job, "json");
        let bytes = match std::fs::read(&path) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(record_error(&path, &error)),
        };
        Ok(serde_json::from_slice(&bytes).ok())
    }

    /// Keeps a job that was run.
    pub(crate) fn write(&self, record: &JobRecord, rows: &Rows) -> Result<(), ArchiveError> {
        write_atomically(&self.path(&record.job, "csv"), &rows.0)?;
        let path = self.path(&record.job, "json");
        let text = serde_json::to_vec_pretty(record).map_err(|e| record_error(&path, &e))?;
        Ok(write_atomically(&path, &text)?)
    }

    /// The rows of jobs, behind columns that say which job each is of.
    pub(crate) fn rows(&self, jobs: &[&Job]) -> Result<DataFrame, ArchiveError> {
        let mut columns = Columns::default();
        for job in jobs {
            let same = [
                ("case", job.case.clone()),
                ("algorithm", job.algorithm.clone()),
                ("seed", job.seed.to_string()),
            ];
            columns.append(&self.path(job, "csv"), &same)?;
        }
        columns.into_frame().map_err(|source| {
            let path = self.folder.clone();
            FrameError::Polars { path, source }.into()
        })
    }
}

fn record_error(path: &Path, what: &dyn std::fmt::Display) -> ArchiveError {
    ArchiveError::Record {
        path: path.into(),
        what: what.to_string(),
    }
}
