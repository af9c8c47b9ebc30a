//! Runs the jobs of an experiment and keeps what they leave behind.

use std::path::Path;
use std::time::Instant;

use indicatif::{ProgressBar, ProgressStyle};
use polars::prelude::DataFrame;
use serde::{Deserialize, Serialize};
use vps_build::write_atomically;

use crate::archive::{Archive, JobRecord, Known, Rows};
use crate::config::ExperimentFile;
use crate::environment::Environment;
use crate::experiments::Error;
use crate::job::{Job, Shard};
use crate::lab::{Lab, Preparation};
use crate::lock::Lock;
use crate::models::sha256;
use crate::pin;

/// Which jobs are run.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Choice<'c> {
    pub(crate) quick: bool,
    /// Only those with this in their name.
    pub(crate) filter: Option<&'c str>,
    pub(crate) shard: Shard,
    /// Whether all is done on one core.
    pub(crate) is_pinned: bool,
}

/// What became of an experiment.
pub(crate) struct Outcome {
    /// Jobs run now, and those that had been run before.
    pub(crate) run: usize,
    pub(crate) kept: usize,
    /// Jobs that are left to other shards or filters.
    pub(crate) missing: usize,
    /// What failed, a line each.
    pub(crate) failures: Vec<String>,
}

/// What all tables of an experiment were made with, kept beside them.
#[derive(Debug, Deserialize, Serialize)]
pub(crate) struct MadeWith {
    pub(crate) experiment: ExperimentFile,
    pub(crate) quick: bool,
    pub(crate) environment: Environment,
    /// Jobs, one line each.
    pub(crate) failures: Vec<String>,
}

/// Runs what has not been run before by this program with the same settings, or of which the record is
/// damaged, and makes the tables when all jobs are done. `folder` is that of the experiment's report,
/// into which only one run writes at a time.
pub(crate) fn run(
    name: &str,
    file: &ExperimentFile,
    choice: Choice<'_>,
    lab: &Lab,
    folder: &Path,
) -> Result<Outcome, Error> {
    let experiment = file.kind()?;
    let jobs = experiment.jobs(choice.quick);
    let core = choice.is_pinned.then(|| pin::to_one_core(choice.shard));
    let environment = Environment::of_now(core.flatten());
    let identity = format!("{} {}", experiment.identity(lab)?, experiment.settings()?);
    let raw = folder.join("raw");
    let _lock = Lock::of(&raw)?;
    let archive = Archive::new(raw);
    let mut outcome = Outcome {
        run: 0,
        kept: 0,
        missing: 0,
        failures: Vec::new(),
    };
    let mut records = Vec::new();
    let progress = ProgressBar::new(jobs.len() as u64);
    let style = "{bar:30} {pos}/{len} jobs, {elapsed} of about {duration}  {msg}";
    progress.set_style(ProgressStyle::with_template(style)?);
    // Drawn between jobs only: a thread that draws would be on the core of what is timed.
    for (number, job) in jobs.iter().enumerate() {
        progress.inc(1);
        let id = format!("{name}/{}", job.id());
        let settings = settings_of(job, &identity, lab)?;
        let damage = match archive.look_up(job)? {
            Known::Nothing => None,
            Known::Damaged(why) => Some(why),
            Known::Record(record) => {
                let is_same = record.environment.program == environment.program;
                if record.status == "ok" && record.settings == settings && is_same {
                    outcome.kept += 1;
                    records.push(*record);
                    continue;
                }
                None
            }
        };
        if !choice.shard.has(number) || choice.filter.is_some_and(|f| !id.contains(f)) {
            outcome.missing += 1;
            continue;
        }
        if let Some(why) = damage {
            progress.suspend(|| eprintln!("vps-bench: {id} is run again: {why}"));
        }
        progress.set_message(id);
        let start = Instant::now();
        let (status, rows, preparation) = match experiment.run(job, lab) {
            Ok(measured) => ("ok".into(), measured.rows, measured.preparation),
            Err(why) => (why, Rows::default(), Preparation::default()),
        };
        let record = JobRecord {
            job: job.clone(),
            settings,
            status,
            rows: rows.count(),
            rows_sha256: rows.sha256(),
            run_s: start.elapsed().as_secs_f64(),
            preparation,
            environment: environment.clone(),
        };
        archive.write(&record, &rows)?;
        outcome.run += 1;
        records.push(record);
    }
    progress.finish_and_clear();
    if outcome.missing == 0 {
        outcome.failures = summarize(file, choice.quick, &archive, &records, folder)?;
        experiment.draw(lab, folder)?;
    }
    Ok(outcome)
}

/// A number for all that decides what a job does.
fn settings_of(job: &Job, identity: &str, lab: &Lab) -> Result<String, Error> {
    let algorithm = match lab.algorithms.get(&job.algorithm) {
        Ok(algorithm) => serde_json::to_string(&algorithm.method)?,
        Err(_) => String::new(),
    };
    let all = format!("{} {identity} {algorithm}", job.id());
    Ok(sha256(all.as_bytes()))
}

/// Makes the small tables from the raw records of all jobs; gives what failed, a line each.
fn summarize(
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
    crate::frame::write(&folder.join("jobs.csv"), &job_table(records)?)?;
    if !done.is_empty() {
        let rows = archive.rows(&done.iter().map(|r| &r.job).collect::<Vec<_>>())?;
        for (name, table) in file.kind()?.summarize(&rows)? {
            crate::frame::write(&folder.join(format!("{name}.csv")), &table)?;
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

/// A row a job.
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
