//! The `vps-compare` command.

#![forbid(unsafe_code)]

mod command;

use std::process::ExitCode;

use clap::Parser;

use crate::command::Args;

fn main() -> ExitCode {
    match command::run(&Args::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("vps-compare: {error}");
            ExitCode::from(2)
        }
    }
}
