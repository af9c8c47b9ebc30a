//! Arguments and options, with the help that `--help` prints.

use std::path::PathBuf;

use clap::{Parser, Subcommand};

use crate::experiments::query_profile::target::{Target, VERB};
use crate::harness::job::Shard;
use crate::harness::run::Selection;

/// Experiments on collision detection: runs them, writes records, tables, figures and verdicts.
#[derive(Parser)]
#[command(version)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(super) command: Command,
    /// Folder of the experiments, of models.toml and algorithms.toml
    #[arg(long, global = true, default_value = "experiments")]
    pub(super) experiments: PathBuf,
    /// Folder of models and assets
    #[arg(long, global = true, default_value = ".cache")]
    pub(super) cache: PathBuf,
    /// Folder of the reports
    #[arg(long, global = true, default_value = "reports")]
    pub(super) out: PathBuf,
}

#[derive(Subcommand)]
pub(super) enum Command {
    /// List the experiments
    List,
    /// Fetch the models, all of them or those named
    Fetch { models: Vec<String> },
    /// Run experiments; records of the same program with the same settings are kept
    Run {
        /// Names of experiments: files in the folder of experiments without `.toml`
        #[arg(required = true)]
        names: Vec<String>,
        #[command(flatten)]
        selection: SelectionArguments,
        /// Another model: a name in models.toml or the path of a mesh
        #[arg(long)]
        model: Option<String>,
        /// Length of a unit of that model, in metres
        #[arg(long, requires = "model")]
        scale: Option<f64>,
    },
    /// Write the report from the tables of all experiments that were run, or of those named
    Report {
        names: Vec<String>,
        /// A file to put tables into, between `<!-- NAME -->` and `<!-- /NAME -->`
        #[arg(long)]
        splice: Option<PathBuf>,
        /// Write nothing; fail if that file or the report is out of date
        #[arg(long, requires = "splice")]
        check: bool,
    },
    /// Judge the claims; fails if a verdict is not the expected one, except in quick runs
    Check { names: Vec<String> },
    /// Times and instructions in folder B as ratios of those in folder A, such as of two machines
    Compare {
        a: PathBuf,
        b: PathBuf,
        /// A row a time, for other programs
        #[arg(long)]
        csv: bool,
        /// Fail if one in B differs from that in A by more than this
        #[arg(long, value_name = "PERCENT")]
        within: Option<f64>,
    },
    /// Execute a query at all poses this many times, to be counted by callgrind
    #[command(hide = true, name = VERB)]
    ExecuteQueries { times: u32, target: Target },
    /// Fetch, run and report everything, then check the claims; a shard of the jobs gives no report
    /// until the other shards are there
    Reproduce {
        #[command(flatten)]
        selection: SelectionArguments,
        /// A file to put tables into
        #[arg(long)]
        splice: Option<PathBuf>,
    },
}

#[derive(clap::Args)]
pub(super) struct SelectionArguments {
    /// The smallest run that covers everything
    #[arg(long)]
    quick: bool,
    /// Only jobs with this in their name, EXPERIMENT/CASE.ALGORITHM.SEED
    #[arg(long)]
    filter: Option<String>,
    /// Only a shard of the jobs, such as 2/3; copy the folders `raw` of all shards together and run
    /// again for the tables
    #[arg(long, value_name = "I/N")]
    shard: Option<Shard>,
    /// Do not pin timed code to a core
    #[arg(long)]
    unpinned: bool,
}

impl SelectionArguments {
    pub(super) fn selection(&self) -> Selection<'_> {
        Selection {
            quick: self.quick,
            filter: self.filter.as_deref(),
            shard: self.shard.unwrap_or(Shard::WHOLE),
            is_pinned: !self.unpinned,
        }
    }
}
