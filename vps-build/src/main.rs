//! The `vps-build` command.

#![forbid(unsafe_code)]

mod commands;

use std::process::ExitCode;

use clap::{CommandFactory, Parser, Subcommand};
use clap_complete::Shell;

use crate::commands::{build, export, inspect, sample};

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
    /// Report the health of a mesh, or the properties of a .vps file
    Inspect(inspect::InspectArgs),
    /// Export points, balls, voxels or the surface of a .vps file as PLY, for viewers
    Export(export::ExportArgs),
    /// Penetration, gradient and error bound at the points of a CSV file
    Sample(sample::SampleArgs),
    /// Print a completion script for a shell
    Completions {
        /// Which shell
        shell: Shell,
    },
}

fn main() -> ExitCode {
    let Cli { command } = Cli::parse();
    let result = match command {
        Command::Build(args) => build::run(&args),
        Command::Inspect(args) => inspect::run(&args),
        Command::Sample(args) => sample::run(&args),
        Command::Export(args) => export::run(&args),
        Command::Completions { shell } => {
            let mut out = std::io::stdout();
            clap_complete::generate(shell, &mut Cli::command(), "vps-build", &mut out);
            Ok(())
        }
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("vps-build: {error}");
            ExitCode::from(2)
        }
    }
}
