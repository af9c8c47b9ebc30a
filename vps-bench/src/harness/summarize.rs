//! Makes the small tables of an experiment from its raw records.

use std::path::Path;

use polars::prelude::DataFrame;
use serde::{Deserialize, Serialize};
use vps_build::write_atomically;

use crate::data::dataframe;
use crate::error::Error;
use crate::experiments::registry::ExperimentFile;
use crate::harness::archive::{Archive, JobRecord};
use crate::harness::environment::Environment;

/// Settings and environment of the tables of an experiment, written beside them.
#[derive(Debug, Deserialize, Serialize)]
pub(crate) struct MadeWith {
    pub(crate) experiment: ExperimentFile,
    pub(crate) quick: bool,
    pub(crate) environment: Environment,
    /// Failed jobs, a line each.
    pub(crate) failures: Vec<String>,
}

/// Makes the small tables from the raw records of all jobs and returns the failures, a line each.
pub(super) fn summarize(
    file: &ExperimentFile,
    quick: bool,
    archive: &Archive,
    records: &[JobRecord],
    folder: &Path,
) -> Result<Vec<String>, Error> {
    let Some(first) = records.first() else {
        return Err("there is nothing to run".into());
    };
    for record in records {
        if let Some(difference) = first.environment.difference(&record.environment) {
            let [a, b] = [first, record].map(|r| r.job.id());
            return Err(format!("{a} and {b} cannot stand in one table: {difference}").into());
        }
    }
    let failed = records.iter().filter(|r| r.status != "ok");
    let mut failures: Vec<_> = failed
        .map(|r| format!("{}: {}", r.job.algorithm, r.status))
        .collect();
    failures.dedup();
    let done: Vec<_> = records.iter().filter(|r| r.status == "ok").collect();
    dataframe::write(&folder.join("jobs.csv"), &job_table(records)?)?;
    if !done.is_empty() {
        let rows = archive.rows(&done.iter().map(|r| &r.job).collect::<Vec<_>>())?;
        for (name, table) in file.kind()?.summarize(&rows)? {
            dataframe::write(&folder.join(format!("{name}.csv")), &table)?;
        }
    }
    let made_with = MadeWith {
        experiment: file.clone(),
        quick,
        environment: first.environment.clone(),
        failures: failures.clone(),
    };
    let text = serde_json::to_vec_pretty(&made_with)?;
    write_atomically(&folder.join("made_with.json"), &text)?;
    Ok(failures)
}

/// A row for each job.
fn job_table(records: &[JobRecord]) -> Result<DataFrame, Error> {
    let text = |f: fn(&JobRecord) -> String| records.iter().map(f).collect::<Vec<_>>();
    let number = |f: fn(&JobRecord) -> f64| records.iter().map(f).collect::<Vec<_>>();
    Ok(polars::df!(
        "case" => text(|r| r.job.case.clone()),
        "algorithm" => text(|r| r.job.algorithm.clone()),
        "seed" => number(|r| f64::from(r.job.seed)),
        "status" => text(|r| r.status.clone()),
        "run_s" => number(|r| r.run_s),
        "prepare_s" => number(|r| r.preparation.prepare_s),
        "asset_build_s" => records.iter().map(|r| r.preparation.asset_build_s).collect::<Vec<_>>(),
        "size" => text(|r| r.preparation.size.clone()),
        "assets" => text(|r| r.preparation.assets.clone()),
        "asset_bytes" => number(|r| r.preparation.asset_bytes as f64),
        "memory_bytes" => number(|r| r.preparation.memory_bytes as f64),
        "settings" => text(|r| r.settings.clone()),
    )?)
}
