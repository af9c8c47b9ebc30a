//! The command: measures algorithms on two meshes at many poses, and summarizes the measurements.

mod args;
mod candidate;
mod catch_panic;
mod comparison;
mod explain;
mod frames;
mod measure;
mod options;
mod poses;
mod prepare;
mod problem;
mod progress;
mod table;
mod worker;

pub(crate) use args::Args;
pub(crate) use explain::{ExplainArgs, run as explain};

use std::path::Path;

use candidate::Candidate;
use comparison::Comparison;
use measure::measure;
use problem::Problem;
use progress::Progress;
use serde::Serialize;
use vps_compare::Algorithm;

/// The error that ends the command: one line for people.
type Error = Box<dyn std::error::Error>;

pub(crate) fn run(args: &Args) -> Result<(), Error> {
    if let Some(name) = &args.worker {
        return worker::work(name, args);
    }
    args.check()?;
    let algorithms = args.algorithms()?;
    let progress = Progress::new()?;
    progress.set("reading the meshes".into());
    let problem = Problem::of(args, &progress)?;
    let mut candidates = Vec::new();
    for name in algorithms.iter().map(Algorithm::key) {
        progress.set(format!("preparing {name}"));
        candidates.push(Candidate::prepare(name, args)?);
    }
    let rows = measure(&problem, &mut candidates, &progress);
    drop(progress);
    if let Some(path) = &args.csv {
        write_csv(path, &rows)?;
    }
    let comparison = Comparison::of(args, &problem, &candidates, &rows);
    if args.json {
        println!("{}", serde_json::to_string_pretty(&comparison)?);
    } else {
        print!("{}", table::text(&comparison));
    }
    Ok(())
}

/// Writes a CSV file with a row for each of `rows`, as a whole or not at all.
fn write_csv(path: &Path, rows: &[impl Serialize]) -> Result<(), Error> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in rows {
        writer.serialize(row)?;
    }
    let bytes = writer.into_inner().map_err(|e| e.into_error())?;
    Ok(vps_build::write_atomically(path, &bytes)?)
}
