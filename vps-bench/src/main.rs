//! Runs experiments and writes their report.
//!
//! `data` and `config` know nothing of the rest. `harness` runs jobs of the `experiments` in their
//! registry and makes tables of the records; `report` makes documents, with `figures`, of the tables
//! alone. `cli` has a file for each verb.

#![forbid(unsafe_code)]

mod cli;
mod config;
mod data;
mod error;
mod experiments;
mod figures;
mod harness;
mod report;

use std::process::ExitCode;

use clap::Parser;

use crate::cli::arguments::Cli;

fn main() -> ExitCode {
    match cli::execute(&Cli::parse()) {
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
