//! Runs experiments and writes their report.

#![forbid(unsafe_code)]

mod algorithms;
mod archive;
mod ball;
mod claims;
mod command;
mod compare;
mod config;
mod environment;
mod experiments;
mod figure;
mod frame;
mod job;
mod lab;
mod lock;
mod models;
mod page;
mod pin;
mod render;
mod report;
mod run;
mod scratch;
mod stats;
mod timed;

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Parser, Subcommand};

use crate::command::Project;
use crate::job::Shard;

/// Experiments on collision detection: runs them, writes records, tables, figures and verdicts.
#[derive(Parser)]
#[command(version)]
struct Cli {
    #[command(subcommand)]
    command: Command,
    /// Folder of the experiments, of models.toml and algorithms.toml
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
    /// List the experiments
    List,
    /// Fetch the models, all of them or those named
    Fetch { models: Vec<String> },
    /// Run experiments; what was run before by the same program with the same settings is kept
    Run {
        /// Names of experiments: files in the folder of experiments without `.toml`
        #[arg(required = true)]
        names: Vec<String>,
        #[command(flatten)]
        choice: ChoiceArguments,
        /// Another model: a name in models.toml or the path of a mesh
        #[arg(long)]
        model: Option<String>,
        /// Metres a unit of that model is long
        #[arg(long, requires = "model")]
        scale: Option<f64>,
    },
    /// Write the report from the tables of all experiments that were run, or of those named
    Report {
        names: Vec<String>,
        /// A file to put tables into, between `<!-- NAME -->` and `<!-- /NAME -->`
        #[arg(long)]
        splice: Option<PathBuf>,
        /// Write nothing; fail if that file or the report is not what it should be
        #[arg(long, requires = "splice")]
        check: bool,
    },
    /// Judge the claims; fails if one turned out otherwise than the experiments say, but not of
    /// quick runs
    Check { names: Vec<String> },
    /// Times in folder B as ratios of those in folder A, such as of two machines
    Compare {
        a: PathBuf,
        b: PathBuf,
        /// A row a time, for other programs
        #[arg(long)]
        csv: bool,
    },
    /// Fetch, run and report everything, then check the claims; of a part of the jobs there is no
    /// report until the other parts are there
    Reproduce {
        #[command(flatten)]
        choice: ChoiceArguments,
        /// A file to put tables into
        #[arg(long)]
        splice: Option<PathBuf>,
    },
}

#[derive(clap::Args)]
struct ChoiceArguments {
    /// As little as shows that all works
    #[arg(long)]
    quick: bool,
    /// Only jobs with this in their name, EXPERIMENT/CASE.ALGORITHM.SEED
    #[arg(long)]
    filter: Option<String>,
    /// Only a part of the jobs, such as 2/3; copy the folders `raw` of all parts together and run
    /// again for the tables
    #[arg(long, value_name = "I/N")]
    shard: Option<Shard>,
    /// Leave it to the system on which core things are timed
    #[arg(long)]
    unpinned: bool,
}

impl ChoiceArguments {
    fn choice(&self) -> run::Choice<'_> {
        run::Choice {
            quick: self.quick,
            filter: self.filter.as_deref(),
            shard: self.shard.unwrap_or(Shard::WHOLE),
            is_pinned: !self.unpinned,
        }
    }
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

/// Does what was asked for; gives what failed of what was done all the same.
fn execute(cli: &Cli) -> Result<Vec<String>, experiments::Error> {
    let project = Project {
        experiments: cli.experiments.clone(),
        cache: cli.cache.clone(),
        out: cli.out.clone(),
    };
    match &cli.command {
        Command::List => project.list(),
        Command::Fetch { models } => project.fetch(models),
        Command::Run {
            names,
            choice,
            model,
            scale,
        } => {
            let other = model.as_deref().map(|model| (model, *scale));
            Ok(project.run(names, choice.choice(), other)?.failures)
        }
        Command::Report {
            names,
            splice,
            check,
        } => project.report(names, splice.as_deref(), *check),
        Command::Check { names } => project.check(names),
        Command::Compare { a, b, csv } => {
            let comparisons = compare::compare(a, b)?;
            if *csv {
                print!("{}", compare::csv(&comparisons)?);
            } else {
                print!("{}", compare::text(&comparisons));
            }
            Ok(Vec::new())
        }
        Command::Reproduce { choice, splice } => {
            project.fetch(&[])?;
            let names = project.names()?;
            let run = project.run(&names, choice.choice(), None)?;
            let mut failures = run.failures;
            if run.missing > 0 {
                return Ok(failures);
            }
            failures.extend(project.report(&[], splice.as_deref(), false)?);
            failures.extend(project.check(&[])?);
            Ok(failures)
        }
    }
}
