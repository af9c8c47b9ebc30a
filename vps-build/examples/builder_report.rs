//! Measures the builder on the bunny, and writes `reports/builder/README.md`: speed, sizes, errors.
//!
//! Run by `just builder-report`, which builds the command and fetches the bunny first.

#[path = "../tests/it/support.rs"]
#[expect(dead_code)]
mod support;

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use glamx::DVec3;
use mesh_to_sdf::{SignMethod, Topology, generate_grid_sdf};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use serde_json::Value;
use vps_build::{Mesh, read_asset, read_mesh, write_atomically};
use vps_core::{DistanceField, Grid, Vec3, Voxelmap};

type Error = Box<dyn std::error::Error>;

const SCALE: &str = "0.135";
const VOXEL_SIZE: &str = "0.00256";
const POINTS: &str = "35596";

/// Voxels compared with brute force, near the surface and elsewhere.
const SAMPLES: usize = 1000;

/// Repetitions of each timing; the median counts.
const RUNS: usize = 3;

fn main() -> Result<(), Error> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let work = root.join("target/builder-report");
    std::fs::create_dir_all(&work)?;
    let bunny_file = root.join(".cache/models/bunny.obj");
    let bunny = read_mesh(&bunny_file, None)?;
    let fine = bunny.subdivided().subdivided();
    let fine_file = work.join("fine.ply");
    std::fs::write(&fine_file, binary_ply(&fine))?;
    let builder = Builder {
        command: root.join("target/release/vps-build"),
        work,
    };
    let report = report(&builder, &bunny_file, &bunny, &fine_file)?;
    write_atomically(&root.join("reports/builder/README.md"), report.as_bytes())?;
    println!("{report}");
    Ok(())
}

/// Runs the command.
struct Builder {
    command: PathBuf,
    work: PathBuf,
}

/// The JSON summary of a build, and its asset.
struct Run {
    json: Value,
    file: PathBuf,
}

impl Builder {
    fn run(&self, mesh: &Path, options: &[&str]) -> Result<Run, Error> {
        let file = self.work.join("out.vps");
        let output = Command::new(&self.command)
            .args([
                "build",
                "--json",
                "--scale",
                SCALE,
                "--voxel-size",
                VOXEL_SIZE,
            ])
            .arg(mesh)
            .arg("-o")
            .arg(&file)
            .args(options)
            .output()?;
        if !output.status.success() {
            return Err(String::from_utf8_lossy(&output.stderr).into());
        }
        Ok(Run {
            json: serde_json::from_slice(&output.stdout)?,
            file,
        })
    }
}

impl Run {
    fn number(&self, name: &str) -> f64 {
        self.json[name].as_f64().unwrap_or(f64::NAN)
    }

    /// All stages except reading the mesh.
    fn built_s(&self) -> f64 {
        ["voxels_s", "distances_s", "points_s", "tree_s"]
            .map(|s| self.number(s))
            .iter()
            .sum()
    }
}

fn middle(mut values: Vec<f64>) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    values[values.len() / 2]
}

fn report(
    builder: &Builder,
    bunny_file: &Path,
    bunny: &Mesh,
    fine_file: &Path,
) -> Result<String, Error> {
    let bunny = bunny.scaled(SCALE.parse()?)?;
    let full = ["--margin", "100", "--points", POINTS];
    // Alternated, so that a disturbance affects both.
    let (mut coarse_runs, mut fine_runs) = (Vec::new(), Vec::new());
    for _ in 0..RUNS {
        coarse_runs.push(builder.run(bunny_file, &full)?);
        fine_runs.push(builder.run(fine_file, &full)?);
    }
    let times = |runs: &[Run], of: &dyn Fn(&Run) -> f64| middle(runs.iter().map(of).collect());
    let distances = |run: &Run| run.number("distances_s");
    let (bunny_distances, bunny_whole) = (
        times(&coarse_runs, &distances),
        times(&coarse_runs, &Run::built_s),
    );
    let (fine_distances, fine_whole) = (
        times(&fine_runs, &distances),
        times(&fine_runs, &Run::built_s),
    );
    let peak = times(&coarse_runs, &|run| run.number("peak_memory_bytes"));
    let first = &coarse_runs[0];

    // The voxels compared, with their exact penetrations.
    let reference = builder.run(bunny_file, &["--margin", "100", "--points", "1"])?;
    let asset = read_asset(&reference.file)?;
    let grid = *asset.voxelmap.grid();
    let s = f64::from(grid.voxel_size());
    let checked = Checked::new(&bunny, &asset.voxelmap);
    let wrong_balls = wrong_balls(&bunny, &asset.voxelmap);

    let mut encodings = String::new();
    let mut default_errors = None;
    for (name, options) in [
        ("distances, sparse", &["--encoding", "distances"][..]),
        (
            "distances, dense",
            &["--encoding", "distances", "--store", "dense"],
        ),
        ("floats, sparse", &["--encoding", "floats"]),
        (
            "floats, dense",
            &["--encoding", "floats", "--store", "dense"],
        ),
        ("layers, sparse", &["--encoding", "layers"]),
        (
            "layers, dense",
            &["--encoding", "layers", "--store", "dense"],
        ),
        ("gradient descent, sparse", &["--closest", "descent"]),
        (
            "gradient descent, dense",
            &["--closest", "descent", "--store", "dense"],
        ),
    ] {
        let run = builder.run(
            bunny_file,
            &[options, &["--margin", "100", "--points", "1"]].concat(),
        )?;
        let asset = read_asset(&run.file)?;
        let map = &asset.voxelmap;
        let stored = |voxel| f64::from(map.center_penetration(voxel));
        let (near, far) = (checked.near.errors(stored), checked.far.errors(stored));
        let error_bounds = map.error_bounds();
        writeln!(
            encodings,
            "| {name} | {:.2} | {:.2} | {:.2} | {:.3} | {:.3} / {:.3} | {:.3} | {:.3} / {:.3} |",
            run.number("distances_s"),
            run.number("map_bytes") / 1e6,
            run.number("file_bytes") / 1e6,
            f64::from(error_bounds.in_band) / s,
            near.mean / s,
            near.largest / s,
            f64::from(error_bounds.beyond) / s,
            far.mean / s,
            far.largest / s,
        )?;
        if name == "distances, sparse" {
            default_errors = Some((near, far, f64::from(map.sigma())));
        }
    }
    let (near, far, lambda) = default_errors.ok_or("the default is in the list")?;

    let mut peers = String::new();
    let mut ratios = Vec::new();
    for (margin, runs) in [("4", RUNS), ("100", 1)] {
        let options = ["--margin", margin, "--points", "1"];
        let dense = [&options[..], &["--store", "dense"]].concat();
        let (mut ours, mut all, mut theirs) = (Vec::new(), Vec::new(), Vec::new());
        let asset = read_asset(&builder.run(bunny_file, &options)?.file)?;
        let map = &asset.voxelmap;
        let mut field = Vec::new();
        for _ in 0..runs {
            ours.push(builder.run(bunny_file, &options)?.number("distances_s"));
            all.push(builder.run(bunny_file, &dense)?.number("distances_s"));
            let start = Instant::now();
            field = by_mesh_to_sdf(&bunny, map.grid());
            theirs.push(start.elapsed().as_secs_f64());
        }
        let dims = map.grid().dims();
        let [_, ny, nz] = dims.map(|n| n as usize);
        // z fastest.
        let given = |[x, y, z]: [u32; 3]| {
            -f64::from(field[(x as usize * ny + y as usize) * nz + z as usize])
        };
        let stored = |voxel| f64::from(map.center_penetration(voxel));
        let checked = Checked::new(&bunny, map);
        let [their_near, their_far] = [checked.near.errors(given), checked.far.errors(given)];
        let [our_near, our_far] = [checked.near.errors(stored), checked.far.errors(stored)];
        let [x, y, z] = dims;
        let (ours, all, theirs) = (middle(ours), middle(all), middle(theirs));
        let ratio = theirs / ours;
        ratios.push(ratio);
        writeln!(
            peers,
            "| {x} x {y} x {z} | {ours:.2} s, error {:.3} / {:.3} | {all:.2} s | {theirs:.2} s, \
             error {:.3} / {:.3} | {ratio:.1} | {:.2} |",
            our_near.largest / s,
            our_far.largest / s,
            their_near.largest / s,
            their_far.largest / s,
            theirs / all,
        )?;
    }

    let [nx, ny, nz] = grid.dims();
    let dense_bytes = 2.0 * f64::from(nx) * f64::from(ny) * f64::from(nz);
    let triangles = first.number("triangles");
    let fine_triangles = fine_runs[0].number("triangles");
    let cpu = cpu();
    Ok(format!(
        "# The builder, measured

`just builder-report` made this on {cpu} ({} threads). The bunny, {triangles} triangles, is 0.27 m
wide as in `experiments/bunny_drop.toml`; voxels have an edge of s = {VOXEL_SIZE} m. Times are the
middle of {RUNS} runs of the command, reading the mesh not counted. `cargo bench -p vps-build` takes
the same times with criterion.

## Speed

| | must | aim | measured |
|---|---|---|---|
| distances for {nx} x {ny} x {nz} voxels of the bunny | 2 s (paper: 10 s) | 0.5 s | {bunny_distances:.2} s |
| the whole asset, {} points | 5 s (paper: 30 s) | 1.5 s | {bunny_whole:.2} s |
| error of stored distance within 4 voxels of the surface | 0.05 s + quantisation ({:.3} s) | quantisation | {:.3} s |
| error anywhere else | 1 s, on the safe side of a sphere test | 0.1 s | {:.3} s at most, {:.3} s on average; {wrong_balls} of {SAMPLES} sphere tests wrong |
| against `mesh_to_sdf` on the same grid (see below) | 5 times faster | 20 | {:.1} times without margin, {:.1} with |
| peak memory, of a dense 16-bit map ({:.1} MB) | 4 | 1 | {:.2} ({:.1} MB) |
| distances for {fine_triangles} triangles, of the bunny's time | 3 | 1.5 | {:.2} ({fine_distances:.2} s) |
| whole asset for {fine_triangles} triangles, of the bunny's time | | | {:.2} ({fine_whole:.2} s) |
| bunny's map, in a file | 1 MB | | {:.3} MB |
| shell and tree of {} points | 2 MB | | {:.3} MB |

The fine mesh is the bunny with every triangle cut into 16.

## Encodings

Errors are those of stored values against every triangle looked at, at {SAMPLES} voxels within 4 s of
the surface and {SAMPLES} elsewhere, in voxel sizes: mean / largest. The bound is what the asset
states. Sizes are of the map alone, in memory, and of the whole file with one point.

| | distances, s | map, MB | file, MB | near: bound | mean / largest | elsewhere: bound | mean / largest |
|---|---|---|---|---|---|---|---|
{encodings}
A dense map computes every voxel from the mesh; a sparse one only what it must.

## Against mesh_to_sdf 0.4

`generate_grid_sdf` with `SignMethod::Raycast` on the same voxel centres, in the same run. Errors
are the largest, in voxel sizes: within 4 s of the surface / elsewhere.

| voxels | vps-build, sparse | dense | mesh_to_sdf | its time of ours, sparse | dense |
|---|---|---|---|---|---|
{peers}",
        rayon::current_num_threads(),
        first.number("points"),
        lambda / s,
        near.largest / s,
        far.largest / s,
        far.mean / s,
        ratios[0],
        ratios[1],
        dense_bytes / 1e6,
        peak / dense_bytes,
        peak / 1e6,
        fine_distances / bunny_distances,
        fine_whole / bunny_whole,
        first.number("map_bytes") / 1e6,
        first.number("points"),
        first.number("tree_bytes") / 1e6,
    ))
}

fn cpu() -> String {
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = info
        .lines()
        .find_map(|line| line.strip_prefix("model name"));
    let name = name.map(|n| n.trim_start_matches([' ', '\t', ':']));
    name.map_or_else(|| "an unknown processor".into(), |n| format!("\"{n}\""))
}

/// Voxels and their exact penetrations in metres.
struct Voxels(Vec<([u32; 3], f64)>);

struct Checked {
    near: Voxels,
    far: Voxels,
}

struct Errors {
    mean: f64,
    largest: f64,
}

impl Checked {
    fn new(mesh: &Mesh, map: &Voxelmap<'_>) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(2014);
        let dims = map.grid().dims();
        let band = 4.0 * map.grid().voxel_size();
        let (mut near, mut far) = (Vec::new(), Vec::new());
        while near.len() < SAMPLES || far.len() < SAMPLES {
            let voxel = dims.map(|n| random.random_range(0..n));
            let is_near = map.center_penetration(voxel).abs() < band;
            let voxels = if is_near { &mut near } else { &mut far };
            if voxels.len() < SAMPLES {
                voxels.push(voxel);
            }
        }
        let exact = |voxels: Vec<[u32; 3]>| {
            let exact = |voxel| {
                let center = map.grid().center(voxel).as_dvec3();
                (voxel, support::exact_penetration(mesh, center))
            };
            Voxels(voxels.into_par_iter().map(exact).collect())
        };
        Self {
            near: exact(near),
            far: exact(far),
        }
    }
}

impl Voxels {
    fn errors(&self, given: impl Fn([u32; 3]) -> f64) -> Errors {
        let errors = self
            .0
            .iter()
            .map(|&(voxel, exact)| (given(voxel) - exact).abs());
        let (mut sum, mut largest) = (0.0, 0.0_f64);
        for error in errors {
            sum += error;
            largest = largest.max(error);
        }
        Errors {
            mean: sum / self.0.len() as f64,
            largest,
        }
    }
}

/// The number of random balls that just reach the surface, but touch nothing by their bound.
fn wrong_balls(mesh: &Mesh, map: &Voxelmap<'_>) -> usize {
    let mut random = ChaCha8Rng::seed_from_u64(4102);
    let bounds = map.grid().bounds();
    let field = map.trilinear();
    let centers: Vec<Vec3> = (0..SAMPLES)
        .map(|_| {
            let t = Vec3::from_array([0; 3].map(|_| random.random_range(0.0..1.0)));
            bounds.min + bounds.extents() * t
        })
        .collect();
    let is_wrong = |&&center: &&Vec3| {
        let distance = -support::exact_penetration(mesh, center.as_dvec3()) as f32;
        // A ball that touches the surface, and must not be culled.
        field.penetration_bound(center, distance.max(0.0) * (1.0 + 1e-5)) < 0.0
    };
    centers.par_iter().filter(is_wrong).count()
}

/// Signed distances of the other library, positive outside, z fastest.
fn by_mesh_to_sdf(mesh: &Mesh, grid: &Grid) -> Vec<f32> {
    let vertices: Vec<[f32; 3]> = mesh
        .vertices()
        .iter()
        .map(|v: &DVec3| v.as_vec3().to_array())
        .collect();
    let indices: Vec<u32> = mesh.triangles().iter().flatten().copied().collect();
    let first = grid.center([0; 3]).to_array();
    let cells = grid.dims().map(|n| n as usize);
    let grid = mesh_to_sdf::Grid::new(first, [grid.voxel_size(); 3], cells);
    generate_grid_sdf(
        &vertices,
        Topology::TriangleList(Some(&indices)),
        &grid,
        SignMethod::Raycast,
    )
}

fn binary_ply(mesh: &Mesh) -> Vec<u8> {
    let mut bytes = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\n\
         property float y\nproperty float z\nelement face {}\n\
         property list uchar int vertex_indices\nend_header\n",
        mesh.vertices().len(),
        mesh.triangles().len()
    )
    .into_bytes();
    for v in mesh.vertices() {
        bytes.extend(v.as_vec3().to_array().iter().flat_map(|c| c.to_le_bytes()));
    }
    for t in mesh.triangles() {
        bytes.push(3);
        bytes.extend(t.iter().flat_map(|v| v.to_le_bytes()));
    }
    bytes
}
