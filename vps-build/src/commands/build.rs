//! `vps-build build`: mesh to asset.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use clap::Args;
use indicatif::ProgressBar;
use vps_build::{BuildOptions, Encoding, Resolution, Stage, build, read_mesh, write_asset};

use super::Error;

#[derive(Args)]
pub(crate) struct BuildArgs {
    /// The mesh, closed and facing outwards: .obj, .ply, .stl or .off
    mesh: PathBuf,
    /// The object of an OBJ file, in place of all
    #[arg(long)]
    object: Option<String>,
    /// Where the asset goes
    #[arg(short, long, value_name = "FILE.vps")]
    output: PathBuf,
    /// Metres a unit of the file is long
    #[arg(long, default_value_t = 1.0)]
    scale: f64,
    /// Edge of a voxel in metres, after scaling
    #[arg(long, conflicts_with = "voxels")]
    voxel_size: Option<f64>,
    /// Voxels along the longest side
    #[arg(long, default_value_t = 100)]
    voxels: u32,
    /// Outer layers of voxels around the mesh
    #[arg(long, default_value_t = 4)]
    margin: u32,
    /// About how many points the pointshell gets
    #[arg(long, default_value_t = 10_000)]
    points: u32,
    /// Children of a cluster, K
    #[arg(short = 'k', long, default_value_t = 4)]
    branching: u32,
    /// Store layers in place of distances
    #[arg(long, conflicts_with = "precision")]
    layers: bool,
    /// Decimal places a distance in metres keeps [default: as many as fit]
    #[arg(long)]
    precision: Option<i32>,
    /// Where the clustering starts
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Most memory the voxels may take while building, in MiB
    #[arg(long, default_value_t = 4096)]
    memory_limit: u64,
}

pub(crate) fn run(args: &BuildArgs) -> Result<(), Error> {
    let start = Instant::now();
    // Draws nothing when standard error is not a terminal.
    let progress = ProgressBar::new_spinner();
    progress.enable_steady_tick(Duration::from_millis(100));
    progress.set_message("reading the mesh");
    let named = |error: &dyn std::fmt::Display| format!("{}: {error}", args.mesh.display());
    let mesh = read_mesh(&args.mesh, args.object.as_deref())?;
    let mesh = mesh.scaled(args.scale).map_err(|e| named(&e))?;
    let options = BuildOptions {
        resolution: match args.voxel_size {
            Some(size) => Resolution::VoxelSize(size),
            None => Resolution::VoxelsAlongLongest(args.voxels),
        },
        margin: args.margin,
        points: args.points,
        branching: args.branching,
        encoding: if args.layers {
            Encoding::Layers
        } else {
            Encoding::Distances(args.precision)
        },
        seed: args.seed,
        memory_limit: args.memory_limit << 20,
    };
    let asset = build(&mesh, &options, &|stage| {
        progress.set_message(match stage {
            Stage::Voxels => "filling voxels",
            Stage::Distances => "measuring distances",
            Stage::Points => "spreading points",
            Stage::Tree => "growing the tree",
        });
    })
    .map_err(|e| named(&e))?;
    write_asset(&args.output, &asset)?;
    progress.finish_and_clear();
    let [x, y, z] = asset.voxelmap.grid().dims();
    println!(
        "{}: {} triangles, {x} x {y} x {z} voxels of {:.6} m, {} points, {} levels, {:.2} s",
        args.output.display(),
        mesh.triangles().len(),
        asset.voxelmap.grid().voxel_size(),
        asset.tree.point_count(),
        asset.tree.level_count(),
        start.elapsed().as_secs_f64(),
    );
    Ok(())
}
