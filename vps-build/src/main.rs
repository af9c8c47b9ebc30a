//! The `vps-build` command.

#![forbid(unsafe_code)]

mod commands;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

use crate::commands::{build, inspect};

/// Builds Voxelmap-Pointshell assets from meshes.
#[derive(Parser)]
#[command(version)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Build a .vps file from a mesh
    Build(build::BuildArgs),
    /// Tell what a mesh or a .vps file is like: a health report
    Inspect(inspect::InspectArgs),
}

fn main() -> ExitCode {
    let Cli { command } = Cli::parse();
    let result = match command {
        Command::Build(args) => build::run(&args),
        Command::Inspect(args) => inspect::run(&args),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("vps-build: {error}");
            ExitCode::from(2)
        }
    }
}
