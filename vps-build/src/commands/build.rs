//! `vps-build build`: mesh to asset.

use std::path::PathBuf;
use std::sync::Mutex;
use std::time::{Duration, Instant};

use clap::{Args, ValueEnum};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::json;
use vps_build::{
    BuildOptions, BuildOutput, ClosestPoints, Clustering, Density, Encoding, PointCount, Repairs,
    Resolution, Sign, Stage, ThinWalls, build, read_mesh, write_asset,
};

use super::Error;

#[derive(Args)]
pub(crate) struct BuildArgs {
    /// The mesh: .obj, .ply, .stl or .off
    mesh: PathBuf,
    /// The object of an OBJ file, in place of all
    #[arg(long)]
    object: Option<String>,
    /// File of the asset
    #[arg(short, long, value_name = "FILE.vps")]
    output: PathBuf,
    /// Length of a unit of the file, in metres
    #[arg(long, default_value_t = 1.0)]
    scale: f64,
    /// Edge of a voxel in metres, after scaling
    #[arg(long, conflicts_with = "voxels", value_name = "METRES")]
    voxel_size: Option<f64>,
    /// Voxels along the longest side, or `auto`: 100, and more if walls are thinner than a voxel
    #[arg(long, default_value = "auto", value_parser = voxels)]
    voxels: Resolution,
    /// Outer layers of voxels around the mesh
    #[arg(long, default_value_t = 4)]
    margin: u32,
    /// Points of the pointshell, to within 2 %
    #[arg(long, default_value_t = 10_000)]
    points: u32,
    /// Distance between points in metres, in place of their number
    #[arg(long, conflicts_with = "points", value_name = "METRES")]
    spacing: Option<f64>,
    /// Children of a cluster, K
    #[arg(short = 'k', long, default_value_t = 4)]
    branching: u32,
    /// Clustering of points
    #[arg(long, value_enum, default_value_t = ClusteringName::Bisect)]
    clustering: ClusteringName,
    /// Encoding of the values
    #[arg(long, value_enum, default_value_t = EncodingName::Distances)]
    encoding: EncodingName,
    /// Decimal places a distance in metres keeps [default: as many as fit 16 bits]
    #[arg(long)]
    precision: Option<i32>,
    /// Search for the point of the mesh closest to a voxel
    #[arg(long, value_enum, default_value_t = ClosestName::Exact)]
    closest: ClosestName,
    /// Whether all voxels are stored
    #[arg(long, value_enum, default_value_t = StoreName::Auto)]
    store: StoreName,
    /// Which side of a face is the inside
    #[arg(long, value_enum, default_value_t = SignName::Auto)]
    sign: SignName,
    /// Seed of bottom-up clustering
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Most memory for voxels and points during the build, in MiB
    #[arg(long, default_value_t = 4096, value_name = "MIB")]
    memory_limit: u64,
    /// Threads to work with; the asset does not depend on it [default: one a core]
    #[arg(long)]
    threads: Option<usize>,
    /// Print errors only
    #[arg(short, long, conflicts_with = "json")]
    quiet: bool,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, ValueEnum)]
enum ClusteringName {
    /// From the top down, by bisection across the principal axis
    Bisect,
    /// As in the paper, from the leaves up, the nearest K together
    BottomUp,
}

#[derive(Clone, Copy, ValueEnum)]
enum EncodingName {
    /// 16-bit layers, a voxel size apart
    Layers,
    /// 16-bit distances in steps of 10^-precision metres
    Distances,
    /// 32-bit floating-point distances
    Floats,
}

#[derive(Clone, Copy, ValueEnum)]
enum ClosestName {
    /// Among all triangles
    Exact,
    /// As in the paper, by gradient descent in the layers
    Descent,
}

#[derive(Clone, Copy, ValueEnum)]
enum StoreName {
    /// Dense for small maps, else sparse
    Auto,
    /// One value a voxel
    Dense,
    /// Only voxels that cannot be interpolated to within one voxel size
    Sparse,
}

#[derive(Clone, Copy, ValueEnum)]
enum SignName {
    /// By winding numbers, generalised ones if the mesh has more holes than faces
    Auto,
    /// By winding numbers, once neighbours agree and holes are closed
    Winding,
    /// By generalised winding numbers, with holes left open
    Generalized,
    /// By a flood fill from outside, whatever the orientation of faces: voxels not reached are inside
    Fill,
}

fn voxels(word: &str) -> Result<Resolution, String> {
    if word == "auto" {
        return Ok(Resolution::Auto);
    }
    let count = word.parse();
    count
        .map(Resolution::VoxelsAlongLongest)
        .map_err(|_| "a whole number or `auto`".into())
}

impl BuildArgs {
    fn options(&self) -> BuildOptions {
        BuildOptions {
            resolution: match self.voxel_size {
                Some(size) => Resolution::VoxelSize(size),
                None => self.voxels,
            },
            margin: self.margin,
            points: match self.spacing {
                Some(spacing) => PointCount::Spacing(spacing),
                None => PointCount::About(self.points),
            },
            branching: self.branching,
            clustering: match self.clustering {
                ClusteringName::Bisect => Clustering::Bisect,
                ClusteringName::BottomUp => Clustering::BottomUp { seed: self.seed },
            },
            encoding: match self.encoding {
                EncodingName::Layers => Encoding::Layers,
                EncodingName::Distances => Encoding::Distances(self.precision),
                EncodingName::Floats => Encoding::Floats,
            },
            closest_points: match self.closest {
                ClosestName::Exact => ClosestPoints::Exact,
                ClosestName::Descent => ClosestPoints::GradientDescent,
            },
            density: match self.store {
                StoreName::Auto => Density::Auto,
                StoreName::Dense => Density::Dense,
                StoreName::Sparse => Density::Sparse,
            },
            sign: match self.sign {
                SignName::Auto => Sign::Auto,
                SignName::Winding => Sign::Winding,
                SignName::Generalized => Sign::Generalized,
                SignName::Fill => Sign::Fill,
            },
            memory_limit: self.memory_limit.saturating_mul(1 << 20),
        }
    }
}

pub(crate) fn run(args: &BuildArgs) -> Result<(), Error> {
    if args.precision.is_some() && !matches!(args.encoding, EncodingName::Distances) {
        return Err("--precision is for --encoding distances".into());
    }
    let threads = args.threads.unwrap_or(0);
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()?;
    let start = Instant::now();
    let progress = progress(args.quiet || args.json);
    let named = |error: &dyn std::fmt::Display| format!("{}: {error}", args.mesh.display());
    let mesh = read_mesh(&args.mesh, args.object.as_deref())?;
    let mesh = mesh.scaled(args.scale).map_err(|e| named(&e))?;
    let stages = Mutex::new(vec![("read_s", start)]);
    let on_stage = |stage| {
        let name = match stage {
            Stage::Solid => "solid_s",
            Stage::Voxels => "voxels_s",
            Stage::Distances => "distances_s",
            Stage::Points => "points_s",
            Stage::Tree => "tree_s",
        };
        if let Ok(mut stages) = stages.lock() {
            stages.push((name, Instant::now()));
        }
        progress.inc(1);
        progress.set_message(match stage {
            Stage::Solid => "finding the boundary of the solid",
            Stage::Voxels => "filling voxels",
            Stage::Distances => "measuring distances",
            Stage::Points => "spreading points",
            Stage::Tree => "growing the tree",
        });
    };
    // The threads of the pool do not share the progress bar.
    let built = pool.install(|| build(&mesh, &args.options(), &on_stage));
    let built = built.map_err(|e| named(&e))?;
    let built_at = Instant::now();
    write_asset(&args.output, &built.asset)?;
    progress.finish_and_clear();
    let seconds = start.elapsed().as_secs_f64();
    if args.json {
        let mut object = summary_json(args, mesh.triangles().len(), &built, seconds);
        let stages = stages.into_inner().unwrap_or_default();
        let ends = stages.iter().skip(1).map(|s| s.1).chain([built_at]);
        for (&(name, start), end) in stages.iter().zip(ends) {
            object[name] = json!((end - start).as_secs_f64());
        }
        object["peak_memory_bytes"] = json!(peak_memory());
        println!("{object}");
    } else if !args.quiet {
        print!(
            "{}",
            summary_text(args, mesh.triangles().len(), &built, seconds)
        );
    }
    Ok(())
}

/// A bar with a step for every stage. Draws nothing if standard error is not a terminal.
fn progress(hidden: bool) -> ProgressBar {
    let progress = ProgressBar::new(6);
    if hidden {
        progress.set_draw_target(ProgressDrawTarget::hidden());
    }
    if let Ok(style) = ProgressStyle::with_template("{spinner} [{bar:20}] {msg} ({elapsed})") {
        progress.set_style(style);
    }
    progress.enable_steady_tick(Duration::from_millis(100));
    progress.set_message("reading the mesh");
    progress
}

fn summary_text(args: &BuildArgs, triangles: usize, built: &BuildOutput, seconds: f64) -> String {
    let BuildOutput { asset, .. } = built;
    let (map, tree) = (&asset.voxelmap, &asset.tree);
    let [x, y, z] = map.grid().dims();
    let kib = |bytes: usize| bytes.div_ceil(1024);
    let is_auto = args.options().resolution == Resolution::Auto;
    format!(
        "{}: {triangles} triangles, {x} x {y} x {z} voxels of {:.6} m in {} KiB, {} points and {} \
         levels in {} KiB, {seconds:.2} s\nsign: {}\n{}{}",
        args.output.display(),
        map.grid().voxel_size(),
        kib(map.store().byte_len()),
        tree.point_count(),
        tree.level_count(),
        kib(tree.byte_len()),
        sign(args.sign, &built.repairs),
        thin_walls(&built.thin_walls, map.grid().voxel_size(), is_auto),
        frame(asset.origin),
    )
}

/// A line on thin walls; empty without them.
fn thin_walls(walls: &ThinWalls, voxel_size: f32, is_auto: bool) -> String {
    let Some(enough) = walls.sufficient_voxel_m else {
        return String::new();
    };
    let percent = |fraction: f64| format!("{:.2} %", 100.0 * fraction);
    let lost = if walls.lost_fraction > 0.0 {
        format!(
            "; of {} of the surface the middle of the wall is outside",
            percent(walls.lost_fraction)
        )
    } else {
        String::new()
    };
    let remark = if is_auto {
        ", which needs a higher --memory-limit"
    } else {
        ", or --voxels auto"
    };
    format!(
        "thin walls: {} of the surface stands for walls thinner than a voxel of {voxel_size:.6} \
         m{lost}: --voxel-size {enough:.3e} would do{remark}\n",
        percent(walls.fraction),
    )
}

/// A line on the origin of the local frame; empty if it is that of the mesh.
fn frame(origin: [f64; 3]) -> String {
    if origin == [0.0; 3] {
        return String::new();
    }
    let [x, y, z] = origin;
    format!("frame: its origin is at ({x}, {y}, {z}) m of the mesh, which is far from its own\n")
}

/// How the inside was found, and the repairs, in words.
fn sign(name: SignName, repairs: &Repairs) -> String {
    let method = match name {
        SignName::Fill => "by a flood fill from outside",
        _ if repairs.is_none() => return "the mesh is watertight".into(),
        _ if repairs.left_open => "by generalised winding numbers, holes left open",
        _ => "by winding numbers",
    };
    let Repairs {
        removed_faces,
        turned_faces,
        closed_holes,
        added_faces,
        hidden_faces,
        merged,
        still_overlapping,
        left_open: _,
    } = *repairs;
    let mut done = Vec::new();
    let mut add = |count: usize, what: &str| {
        if count > 0 {
            let plural = if count == 1 { "" } else { "s" };
            done.push(
                what.replace("{}", &count.to_string())
                    .replace("(s)", plural),
            );
        }
    };
    add(removed_faces, "{} double or degenerate face(s) removed");
    add(turned_faces, "{} face(s) turned");
    add(
        closed_holes,
        &format!("{{}} hole(s) closed with {added_faces} faces"),
    );
    add(hidden_faces, "{} face(s) within the solid removed");
    if merged {
        done.push("parts that overlap or touch joined".into());
    }
    if still_overlapping {
        done.push("parts overlap still, depths near faces within the solid are too small".into());
    }
    if done.is_empty() {
        return method.into();
    }
    format!("{method}, after repairs: {}", done.join(", "))
}

/// Peak memory of this process in bytes, on Linux.
fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status
        .lines()
        .find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kib: u64 = line.split_whitespace().next()?.parse().ok()?;
    Some(kib * 1024)
}

fn summary_json(
    args: &BuildArgs,
    triangles: usize,
    built: &BuildOutput,
    seconds: f64,
) -> serde_json::Value {
    let BuildOutput {
        asset,
        repairs,
        thin_walls,
    } = built;
    let (map, tree) = (&asset.voxelmap, &asset.tree);
    json!({
        "file": args.output,
        "file_bytes": asset.to_bytes().len(),
        "triangles": triangles,
        "origin_m": asset.origin,
        "voxels": map.grid().dims(),
        "voxel_size_m": map.grid().voxel_size(),
        "sigma_m": map.sigma(),
        "dense": map.store().is_dense(),
        "map_bytes": map.store().byte_len(),
        "points": tree.point_count(),
        "levels": tree.level_count(),
        "tree_bytes": tree.byte_len(),
        "watertight": repairs.is_none(),
        "removed_faces": repairs.removed_faces,
        "turned_faces": repairs.turned_faces,
        "closed_holes": repairs.closed_holes,
        "added_faces": repairs.added_faces,
        "hidden_faces": repairs.hidden_faces,
        "left_open": repairs.left_open,
        "merged": repairs.merged,
        "still_overlapping": repairs.still_overlapping,
        "thin_fraction": thin_walls.fraction,
        "lost_fraction": thin_walls.lost_fraction,
        "sufficient_voxel_m": thin_walls.sufficient_voxel_m,
        "seconds": seconds,
    })
}
