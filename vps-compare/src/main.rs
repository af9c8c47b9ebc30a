//! The `vps-compare` command.

#![forbid(unsafe_code)]

mod command;

use std::process::ExitCode;

use clap::{CommandFactory, FromArgMatches, Subcommand};

use crate::command::{Args, ExplainArgs};

/// The verbs; without one, algorithms are compared.
#[derive(Subcommand)]
enum Verb {
    Explain(ExplainArgs),
}

fn main() -> ExitCode {
    let matches = Verb::augment_subcommands(Args::command()).get_matches();
    let result = if matches.subcommand_name().is_some() {
        Verb::from_arg_matches(&matches).map(|Verb::Explain(args)| command::explain(&args))
    } else {
        Args::from_arg_matches(&matches).map(|args| command::run(&args))
    };
    match result.unwrap_or_else(|error| error.exit()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("vps-compare: {error}");
            ExitCode::from(2)
        }
    }
}
