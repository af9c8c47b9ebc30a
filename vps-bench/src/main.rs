//! Runs experiments and writes their reports.

#![forbid(unsafe_code)]

mod config;
mod drop;
mod environment;
mod figures;
mod models;
mod records;
mod report;
mod run;
mod summary;
mod timed;

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;

use clap::{Parser, Subcommand};
use indicatif::ProgressBar;
use vps_build::AssetCache;

use crate::config::Experiment;
use crate::models::Models;
use crate::run::Records;

/// Experiments on collision detection: runs them, writes records, tables and figures.
#[derive(Parser)]
#[command(version)]
struct Cli {
    #[command(subcommand)]
    command: Command,
    /// Folder of the experiments and of models.toml
    #[arg(long, global = true, default_value = "experiments")]
    experiments: PathBuf,
    /// Where models and assets are kept
    #[arg(long, global = true, default_value = ".cache")]
    cache: PathBuf,
    /// Folder of the reports
    #[arg(long, global = true, default_value = "reports")]
    out: PathBuf,
}

#[derive(Subcommand)]
enum Command {
    /// Fetch the models, all of them or those named
    Fetch { models: Vec<String> },
    /// Run experiments and write their records and reports
    Run {
        /// Names of experiments: files in the folder of experiments without `.toml`
        #[arg(required = true)]
        names: Vec<String>,
        /// Few start orientations, to see that all works
        #[arg(long)]
        quick: bool,
        /// Another model: a name in models.toml or the path of an OBJ file
        #[arg(long)]
        model: Option<String>,
        /// Metres a unit of that model is long
        #[arg(long, requires = "model")]
        scale: Option<f64>,
    },
    /// Write the reports again from the records
    Report {
        #[arg(required = true)]
        names: Vec<String>,
        /// A file to put the tables into, between `<!-- NAME -->` and `<!-- /NAME -->`
        #[arg(long)]
        splice: Option<PathBuf>,
    },
}

fn main() -> ExitCode {
    match execute(&Cli::parse()) {
        Ok(failures) if failures.is_empty() => ExitCode::SUCCESS,
        Ok(failures) => {
            for failure in failures {
                eprintln!("vps-bench: {failure}");
            }
            ExitCode::from(1)
        }
        Err(error) => {
            eprintln!("vps-bench: {error}");
            ExitCode::from(2)
        }
    }
}

/// Does what was asked for; gives what failed of an experiment that was run all the same.
fn execute(cli: &Cli) -> Result<Vec<String>, Box<dyn std::error::Error>> {
    let mut failures = Vec::new();
    let models = || {
        Models::read(
            &cli.experiments.join("models.toml"),
            &cli.cache.join("models"),
        )
    };
    match &cli.command {
        Command::Fetch { models: names } => {
            let models = models()?;
            let all: Vec<_> = models.names().map(String::from).collect();
            for name in if names.is_empty() { &all } else { names } {
                let progress = ProgressBar::new_spinner().with_message(format!("fetching {name}"));
                progress.enable_steady_tick(Duration::from_millis(200));
                let file = models.file(name)?;
                progress.finish_and_clear();
                println!("{name}: {}", file.display());
            }
        }
        Command::Run {
            names,
            quick,
            model,
            scale,
        } => {
            let (models, assets) = (models()?, AssetCache::new(cli.cache.join("assets")));
            for name in names {
                let path = cli.experiments.join(format!("{name}.toml"));
                let mut experiment = Experiment::read(&path)?;
                if let Some(model) = model {
                    experiment.body.model.clone_from(model);
                }
                experiment.body.scale = scale.unwrap_or(experiment.body.scale);
                let records = run::run(&experiment, *quick, &models, &assets)?;
                let folder = cli.out.join(name);
                records.write(&folder)?;
                let table = report::report(&folder, &records)?;
                failures.extend(records.failures());
                println!("{}\n\n{table}", experiment.title);
                println!("{}", folder.join("report.md").display());
            }
        }
        Command::Report { names, splice } => {
            for name in names {
                let folder = cli.out.join(name);
                let table = report::report(&folder, &Records::read(&folder)?)?;
                if let Some(path) = splice {
                    report::splice(path, name, &table)?;
                }
                println!("{}", folder.join("report.md").display());
            }
        }
    }
    Ok(failures)
}
