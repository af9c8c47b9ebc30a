//! Raw records: for each job a CSV file of rows, and a JSON file that describes them.
//!
//! The JSON file is written last, with the number and the checksum of the rows: a job is done if
//! they match the CSV file. Folders of several machines are merged by copying them into one.

use std::path::{Path, PathBuf};

use polars::prelude::DataFrame;
use serde::{Deserialize, Serialize};
use vps_build::{FileError, write_atomically};

use crate::data::checksum::sha256;
use crate::data::dataframe::{Columns, DataFrameError};
use crate::harness::environment::Environment;
use crate::harness::job::Job;
use crate::harness::prepare::Preparation;

/// The record of a job that was run.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub(crate) struct JobRecord {
    pub(crate) job: Job,
    /// SHA-256 of all inputs of the job: the experiment, its algorithm, its model.
    pub(crate) settings: String,
    /// `ok`, or why there are no rows.
    pub(crate) status: String,
    /// The number of rows, and the SHA-256 of their file.
    pub(crate) rows: usize,
    pub(crate) rows_sha256: String,
    pub(crate) run_s: f64,
    pub(crate) preparation: Preparation,
    pub(crate) environment: Environment,
}

/// The rows of a job, as a CSV file.
#[derive(Debug, Default)]
pub(crate) struct Rows {
    csv: Vec<u8>,
    count: usize,
}

/// The result of looking up a job.
pub(crate) enum Lookup {
    Missing,
    Found(Box<JobRecord>),
    /// The files are not as they were written, and why.
    Damaged(String),
}

#[derive(Debug, thiserror::Error)]
pub(crate) enum ArchiveError {
    #[error("{}: {message}", path.display())]
    Record { path: PathBuf, message: String },
    #[error(transparent)]
    DataFrame(#[from] DataFrameError),
    #[error(transparent)]
    File(#[from] FileError),
}

impl Rows {
    /// Serializes rows; fields become columns of the same name.
    pub(crate) fn of<R: Serialize>(rows: &[R]) -> Result<Self, String> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        for row in rows {
            writer.serialize(row).map_err(|e| e.to_string())?;
        }
        let csv = writer.into_inner().map_err(|e| e.to_string())?;
        Ok(Self {
            csv,
            count: rows.len(),
        })
    }

    pub(crate) fn count(&self) -> usize {
        self.count
    }

    pub(crate) fn sha256(&self) -> String {
        sha256(&self.csv)
    }
}

/// The raw records of an experiment.
pub(crate) struct Archive {
    folder: PathBuf,
}

impl Archive {
    /// An archive in a folder, which is made when it is needed.
    pub(crate) fn new(folder: impl Into<PathBuf>) -> Self {
        Self {
            folder: folder.into(),
        }
    }

    fn path(&self, job: &Job, extension: &str) -> PathBuf {
        self.folder.join(format!("{}.{extension}", job.id()))
    }

    /// Looks up a job; its rows are read and checked.
    pub(crate) fn look_up(&self, job: &Job) -> Result<Lookup, ArchiveError> {
        let [json, csv] = ["json", "csv"].map(|extension| self.path(job, extension));
        let damaged =
            |path: &Path, message: &str| Lookup::Damaged(format!("{}: {message}", path.display()));
        Ok(match (read(&json)?, read(&csv)?) {
            (None, None) => Lookup::Missing,
            (None, Some(_)) => damaged(&json, "missing, the rows beside it may not be all"),
            (Some(_), None) => damaged(&csv, "missing"),
            (Some(bytes), Some(rows)) => match serde_json::from_slice::<JobRecord>(&bytes) {
                Err(error) => damaged(&json, &error.to_string()),
                Ok(record) if record.rows_sha256 != sha256(&rows) => {
                    let lines = rows.iter().filter(|b| **b == b'\n').count();
                    let (found, written) = (lines.saturating_sub(1), record.rows);
                    let message =
                        format!("{found} rows that are not the {written} that were written");
                    damaged(&csv, &message)
                }
                Ok(record) => Lookup::Found(record.into()),
            },
        })
    }

    /// Writes the rows and the record of a job.
    pub(crate) fn write(&self, record: &JobRecord, rows: &Rows) -> Result<(), ArchiveError> {
        write_atomically(&self.path(&record.job, "csv"), &rows.csv)?;
        let path = self.path(&record.job, "json");
        let text = serde_json::to_vec_pretty(record).map_err(|e| record_error(&path, &e))?;
        Ok(write_atomically(&path, &text)?)
    }

    /// The rows of jobs, behind the columns `case`, `algorithm` and `seed`.
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
        columns.into_dataframe().map_err(|source| {
            let path = self.folder.clone();
            DataFrameError::Polars { path, source }.into()
        })
    }
}

/// The bytes of a file; `None` if it does not exist.
fn read(path: &Path) -> Result<Option<Vec<u8>>, ArchiveError> {
    match std::fs::read(path) {
        Ok(bytes) => Ok(Some(bytes)),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(record_error(path, &error)),
    }
}

fn record_error(path: &Path, message: &dyn std::fmt::Display) -> ArchiveError {
    ArchiveError::Record {
        path: path.into(),
        message: message.to_string(),
    }
}
