//! Runs the jobs of an experiment and keeps their records.

use std::path::Path;
use std::time::Instant;

use indicatif::{ProgressBar, ProgressStyle};

use crate::data::checksum::sha256;
use crate::error::Error;
use crate::experiments::registry::ExperimentFile;
use crate::harness::affinity;
use crate::harness::archive::{Archive, JobRecord, Lookup, Rows};
use crate::harness::context::Context;
use crate::harness::environment::Environment;
use crate::harness::job::{Job, Shard};
use crate::harness::lock::FolderLock;
use crate::harness::prepare::Preparation;
use crate::harness::summarize::summarize;

/// The jobs that are run.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Selection<'c> {
    pub(crate) quick: bool,
    /// Only jobs whose name contains this.
    pub(crate) filter: Option<&'c str>,
    pub(crate) shard: Shard,
    /// Whether the run is pinned to one core.
    pub(crate) is_pinned: bool,
}

/// The result of running an experiment.
pub(crate) struct Outcome {
    /// Jobs run now, and jobs kept from earlier runs.
    pub(crate) run: usize,
    pub(crate) kept: usize,
    /// Jobs left to other shards or filters.
    pub(crate) missing: usize,
    /// Failures, a line each.
    pub(crate) failures: Vec<String>,
}

/// Runs the jobs that this program has not run before with the same settings, or whose record is
/// damaged, and makes the tables when all jobs are done. `folder` is that of the experiment's
/// report; only one run writes into it at a time.
pub(crate) fn run(
    name: &str,
    file: &ExperimentFile,
    selection: Selection<'_>,
    context: &Context,
    folder: &Path,
) -> Result<Outcome, Error> {
    let experiment = file.kind()?;
    let jobs = experiment.jobs(selection.quick);
    let core = selection
        .is_pinned
        .then(|| affinity::pin_to_core(selection.shard));
    let environment = Environment::of_now(core.flatten());
    let identity = format!("{} {}", experiment.identity(context)?, file.physics()?);
    let raw = folder.join("raw");
    let _lock = FolderLock::of(&raw)?;
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
    // Drawn between jobs only: a drawing thread would share the core with the timed code.
    for (number, job) in jobs.iter().enumerate() {
        progress.inc(1);
        let id = format!("{name}/{}", job.id());
        let settings = settings_of(job, &identity, context)?;
        let damage = match archive.look_up(job)? {
            Lookup::Missing => None,
            Lookup::Damaged(why) => Some(why),
            Lookup::Found(record) => {
                let is_same_program = record.environment.program == environment.program;
                if record.status == "ok" && record.settings == settings && is_same_program {
                    outcome.kept += 1;
                    records.push(*record);
                    continue;
                }
                None
            }
        };
        if !selection.shard.contains(number) || selection.filter.is_some_and(|f| !id.contains(f)) {
            outcome.missing += 1;
            continue;
        }
        if let Some(why) = damage {
            progress.suspend(|| eprintln!("vps-bench: {id} is run again: {why}"));
        }
        progress.set_message(id);
        let start = Instant::now();
        let (status, rows, preparation) = match experiment.run(job, context) {
            Ok(measurement) => ("ok".into(), measurement.rows, measurement.preparation),
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
        outcome.failures = summarize(file, selection.quick, &archive, &records, folder)?;
        experiment.draw(context, folder)?;
    }
    Ok(outcome)
}

/// A checksum of all inputs of a job.
fn settings_of(job: &Job, identity: &str, context: &Context) -> Result<String, Error> {
    let algorithm = match context.algorithms.get(&job.algorithm) {
        Ok(algorithm) => serde_json::to_string(&algorithm.method)?,
        Err(_) => String::new(),
    };
    let all = format!("{} {identity} {algorithm}", job.id());
    Ok(sha256(all.as_bytes()))
}
