//! Instructions and cache misses of queries, counted by `valgrind --tool=callgrind`.
//!
//! Without an argument (`just query-profile`) the counts are written to `reports/queries/profile.csv`
//! and as a table to `profile.md` beside it. With `gate` (`just gate`) they are compared with those
//! of the file, and a difference of more than 2 % is a failure.

#[path = "../benches/setting/mod.rs"]
mod setting;

use std::fmt::Write;
use std::fs::File;
use std::hint::black_box;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

use setting::{AROUND, FINE, GROUND, bunny, bunny_options, cuboid, ground_options};
use vps_build::{
    BuildOptions, Density, Mesh, PointCount, build, read_asset, write_asset, write_atomically,
};
use vps_core::{Asset, CountWork, DistanceField, Pose3, Quat, Query, Vec3, Weight, Work};

const POSES: u32 = 20;
/// How often more all poses are asked in the second of two runs; the difference is what counts.
const TIMES: u64 = 10;

const ROWS: [(&str, &str); 11] = [
    ("deepest", "cuboid"),
    ("deepest", "dense"),
    ("deepest", "sparse"),
    ("manifold of 4", "cuboid"),
    ("manifold of 4", "dense"),
    ("manifold of 4", "sparse"),
    ("force and torque", "cuboid"),
    ("force and torque", "dense"),
    ("force and torque", "sparse"),
    ("force and torque, all inside", "dense"),
    ("force and torque, all inside", "sparse"),
];

/// By how much the instructions of a query may differ from those kept, as a part of these.
const TOLERANCE: f64 = 0.02;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match &arguments[..] {
        [] => report(),
        [gate] if gate == "gate" => return self::gate(),
        [query, field, times] => {
            let times = times.parse().expect("a number");
            run(query, field, times, None);
        }
        _ => panic!("no argument, gate, or QUERY FIELD TIMES"),
    }
    ExitCode::SUCCESS
}

fn file(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../target/query-profile");
    std::fs::create_dir_all(&folder).expect("a place for assets");
    folder.join(format!("{name}.vps"))
}

/// The file in `reports/queries`.
fn reported(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../reports/queries");
    folder.join(name)
}

/// Counts of one query: a mean over the poses.
struct Profile {
    spheres: f64,
    points: f64,
    instructions: f64,
    first_level_misses: f64,
    last_level_misses: f64,
}

fn profile(query: &str, field: &str) -> Profile {
    let [less, more] = [1, 1 + TIMES].map(|times| counted(query, field, times));
    let queries = (TIMES * u64::from(POSES)) as f64;
    let mean = |i: usize| (more[i] as f64 - less[i] as f64).max(0.0) / queries;
    let work = Work::default();
    run(query, field, 1, Some(&work));
    let [spheres, points] = [work.spheres(), work.points()].map(|n| n as f64 / f64::from(POSES));
    Profile {
        spheres,
        points,
        instructions: mean(0),
        first_level_misses: mean(3) + mean(4) + mean(5),
        last_level_misses: mean(6) + mean(7) + mean(8),
    }
}

/// Builds the bunny and the grounds it is put into.
fn build_assets() {
    let ground = Mesh::cuboid(GROUND).expect("a box");
    let around = Mesh::cuboid(AROUND).expect("a box");
    let make = |name: &str, mesh: &Mesh, options: &BuildOptions| {
        let asset = build(mesh, options, &|_| ()).expect("a sound mesh").asset;
        write_asset(&file(name), &asset).expect("a place for assets");
    };
    make("bunny", &bunny(), &bunny_options(PointCount::About(FINE)));
    for (name, density) in [("dense", Density::Dense), ("sparse", Density::Sparse)] {
        let options = ground_options(density);
        make(name, &ground, &options);
        make(&format!("around_{name}"), &around, &options);
    }
}

const COLUMNS: [&str; 7] = [
    "query",
    "field",
    "spheres",
    "points",
    "instructions",
    "first_level_misses",
    "last_level_misses",
];

fn report() {
    build_assets();
    let mut records = csv::Writer::from_writer(Vec::new());
    records.write_record(COLUMNS).expect("memory");
    let mut text = String::from(
        "# Instructions of queries\n\n\
         Written by `just query-profile`: counted by callgrind, a query on average. The bunny of\n\
         35 596 points stands 1 mm deep in the ground in 20 orientations, asked 20 mm ahead. A batch\n\
         is four spheres or points that are looked at together. Misses are those of callgrind's model\n\
         of the caches, first level and last, when the same poses are asked again and again.\n\
         `just gate` fails if instructions differ by more than 2 % from those here.\n\n\
         | query | field | spheres | points | instructions | a batch | first-level misses | last-level misses |\n\
         |---|---|---|---|---|---|---|---|\n",
    );
    for (query, field) in ROWS {
        let profile = profile(query, field);
        let [spheres, points, instructions, first, last] = [
            profile.spheres,
            profile.points,
            profile.instructions,
            profile.first_level_misses,
            profile.last_level_misses,
        ]
        .map(|count| format!("{count:.0}"));
        let a_batch = 4.0 * profile.instructions / (profile.spheres + profile.points);
        writeln!(
            text,
            "| {query} | {field} | {spheres} | {points} | {instructions} | {a_batch:.0} | {first} | {last} |",
        )
        .expect("memory");
        records
            .write_record([
                query,
                field,
                &spheres,
                &points,
                &instructions,
                &first,
                &last,
            ])
            .expect("memory");
    }
    print!("{text}");
    let records = records.into_inner().expect("memory");
    for (name, bytes) in [
        ("profile.csv", &records[..]),
        ("profile.md", text.as_bytes()),
    ] {
        write_atomically(&reported(name), bytes).expect("a place for the report");
    }
}

/// Prints the instructions of each query beside those kept.
fn gate() -> ExitCode {
    build_assets();
    let kept = reported("profile.csv");
    let mut is_passed = true;
    println!(
        "{:<32} {:<8} {:>12} {:>12} {:>8}",
        "query", "field", "instructions", "kept", "change"
    );
    let file = File::open(&kept).expect("profile.csv, which `just query-profile` writes");
    for record in csv::Reader::from_reader(file).records() {
        let record = record.expect("a record");
        let (query, field) = (&record[0], &record[1]);
        let kept: f64 = record[4].parse().expect("a count");
        let instructions = profile(query, field).instructions;
        let change = instructions / kept - 1.0;
        let is_near = change.abs() <= TOLERANCE;
        is_passed &= is_near;
        let verdict = if is_near {
            ""
        } else {
            "  differs by more than 2 %"
        };
        println!(
            "{query:<32} {field:<8} {instructions:>12.0} {kept:>12.0} {:>+7.2}%{verdict}",
            100.0 * change,
        );
    }
    if is_passed {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}

/// What callgrind counts: instructions, reads, writes, and misses of these three in the first and in
/// the last level.
fn counted(query: &str, field: &str, times: u64) -> Vec<u64> {
    let this = std::env::current_exe().expect("a program");
    let output = Command::new("valgrind")
        .args([
            "--tool=callgrind",
            "--cache-sim=yes",
            "--callgrind-out-file=/dev/null",
        ])
        .arg(this)
        .args([query, field, &times.to_string()])
        .output()
        .expect("valgrind is installed");
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    let line = said
        .lines()
        .find_map(|line| line.split_once("Collected : "));
    let (_, counts) = line.unwrap_or_else(|| panic!("valgrind failed: {said}"));
    let counts = counts.split_whitespace();
    counts.map(|n| n.parse().expect("a count")).collect()
}

/// Asks all poses so many times.
fn run(query: &str, field: &str, times: u64, work: Option<&Work>) {
    let shell = read_asset(&file("bunny")).expect("an asset");
    let (query, is_inside) = match query.strip_suffix(", all inside") {
        Some(query) => (query, true),
        None => (query, false),
    };
    if field == "cuboid" {
        return ask(query, &shell, &cuboid(GROUND), is_inside, times, work);
    }
    let name = if is_inside {
        format!("around_{field}")
    } else {
        field.into()
    };
    let asset = read_asset(&file(&name)).expect("an asset");
    ask(
        query,
        &shell,
        &asset.voxelmap.trilinear(),
        is_inside,
        times,
        work,
    );
}

fn ask<F: DistanceField>(
    query: &str,
    shell: &Asset<'_>,
    field: &F,
    is_inside: bool,
    times: u64,
    work: Option<&Work>,
) {
    let (tree, center) = (&shell.tree, shell.mass.center());
    for pose in 0..POSES {
        // By the golden angle from pose to pose.
        let turn = Quat::from_scaled_axis(Vec3::new(1.0, 0.5, 0.3) * (2.4 * pose as f32));
        let mut pose = Pose3::from_parts(-(turn * center), turn);
        if !is_inside {
            let low = tree
                .points()
                .iter()
                .map(|&p| pose.transform_point(p.into()).y);
            pose.translation.y +=
                0.5 * GROUND[1] as f32 - 0.001 - low.fold(f32::INFINITY, f32::min);
        }
        let margin = if is_inside { 0.0 } else { 0.02 };
        let asked = Query::new(tree, field, pose).with_prediction(margin);
        for _ in 0..times {
            match work {
                None => answer(query, &asked),
                Some(work) => answer(query, &asked.counting(work)),
            }
        }
    }
}

fn answer<F: DistanceField, W: CountWork + Copy>(name: &str, query: &Query<'_, F, W>) {
    match name {
        "deepest" => _ = black_box(query.deepest()),
        "manifold of 4" => _ = black_box(query.manifold::<4>()),
        _ => _ = black_box(query.wrench(Vec3::ZERO, Weight::Area)),
    }
}
