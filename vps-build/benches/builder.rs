//! Times of the stages of a build, on the bunny of the paper's experiment. Fetch it first with
//! `just fetch`.

use std::path::Path;
use std::sync::Mutex;
use std::time::{Duration, Instant};

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use mesh_to_sdf::{Grid, SignMethod, Topology, generate_grid_sdf};
use vps_build::{BuildOptions, Density, Mesh, PointCount, Resolution, Stage, build, read_mesh};

fn bunny() -> Mesh {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../.cache/models/bunny.obj");
    let bunny = read_mesh(&path, None).expect("the bunny: `just fetch` brings it");
    bunny.scaled(0.135).expect("a sound scale")
}

fn options(margin: u32, points: u32) -> BuildOptions {
    BuildOptions {
        resolution: Resolution::VoxelSize(0.00256),
        margin,
        points: PointCount::About(points),
        ..BuildOptions::default()
    }
}

/// Time of the distance stage of a whole build.
fn distances(mesh: &Mesh, options: &BuildOptions) -> Duration {
    let times = Mutex::new(Vec::new());
    let note = |stage| times.lock().unwrap().push((stage, Instant::now()));
    build(mesh, options, &note).unwrap();
    let times = times.into_inner().unwrap();
    let at = |stage: Stage| times.iter().find(|t| t.0 == stage).unwrap().1;
    at(Stage::Points) - at(Stage::Distances)
}

fn builder(criterion: &mut Criterion) {
    let bunny = bunny();
    let fine = bunny.subdivided().subdivided();

    let mut group = criterion.benchmark_group("distances_306x305x282");
    group.sample_size(10);
    for mesh in [&bunny, &fine] {
        let id = BenchmarkId::new("vps-build", mesh.triangles().len());
        group.bench_function(id, |bencher| {
            bencher
                .iter_custom(|times| (0..times).map(|_| distances(mesh, &options(100, 1))).sum());
        });
    }
    group.finish();

    let mut group = criterion.benchmark_group("asset_306x305x282_35596_points");
    group.sample_size(10);
    for mesh in [&bunny, &fine] {
        group.bench_function(
            BenchmarkId::new("vps-build", mesh.triangles().len()),
            |bencher| {
                bencher.iter(|| build(mesh, &options(100, 35_596), &|_| ()).unwrap());
            },
        );
    }
    group.finish();

    // The same voxels by a general library, and by dense and sparse builds.
    let mut group = criterion.benchmark_group("distances_114x113x90");
    group.sample_size(10);
    let dense = BuildOptions {
        density: Density::Dense,
        ..options(4, 1)
    };
    for (name, options) in [("vps-build", options(4, 1)), ("vps-build dense", dense)] {
        group.bench_function(name, |bencher| {
            bencher.iter_custom(|times| (0..times).map(|_| distances(&bunny, &options)).sum());
        });
    }
    let grid = *build(&bunny, &options(4, 1), &|_| ())
        .unwrap()
        .asset
        .voxelmap
        .grid();
    let vertices: Vec<[f32; 3]> = bunny
        .vertices()
        .iter()
        .map(|v| v.as_vec3().to_array())
        .collect();
    let indices: Vec<u32> = bunny.triangles().iter().flatten().copied().collect();
    let first = grid.center([0; 3]).to_array();
    let cells = grid.dims().map(|n| n as usize);
    group.bench_function("mesh_to_sdf", |bencher| {
        let grid = Grid::new(first, [grid.voxel_size(); 3], cells);
        bencher.iter(|| {
            let topology = Topology::TriangleList(Some(&indices));
            generate_grid_sdf(&vertices, topology, &grid, SignMethod::Raycast)
        });
    });
    group.finish();
}

criterion_group!(benches, builder);
criterion_main!(benches);
