//! How long queries take beside those of parry, in the same run and for the same poses, and the
//! table of it in `reports/queries`. Fetch the bunny first: `just query-report`.

mod setting;

use std::fmt::Write;
use std::hint::black_box;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use criterion::{Criterion, SamplingMode};
use rapier3d::parry::query::{DefaultQueryDispatcher, QueryDispatcher};
use rapier3d::prelude::*;
use setting::{AROUND, FINE, GROUND, bunny, bunny_options, cuboid, ground_options};
use vps_build::{
    BuildOptions, Clustering, Density, Mesh, PointCount, Resolution, build, models,
    write_atomically,
};
use vps_compare::{
    CollisionAlgorithm, Contacts, ConvexDecomposition, ConvexHull, Dispatcher, Ground, Memory,
    Prepared, Scene, Trimesh, Vps,
};
use vps_core::{Asset, Contact, DistanceField, PointSphereTree, Query, Trilinear, Weight, Work};
use vps_rapier::{VpsDispatcher, VpsShape};

/// How far ahead contacts are asked for in metres: rapier's default.
const PREDICTION: f32 = 0.02;
const COARSE: u32 = 799;
/// How often those that are compared take turns; odd, for the median.
const ROUNDS: usize = 3;

fn main() {
    let mut criterion = Criterion::default()
        .configure_from_args()
        .sample_size(10)
        .warm_up_time(Duration::from_millis(100))
        .measurement_time(Duration::from_millis(400));
    let mut table = Table::default();
    let bunny = bunny();
    let [fine, coarse] = [FINE, COARSE].map(|points| shell(&bunny, points));
    let poses = rolling(&bunny, &fine);
    ground(&mut criterion, &mut table, &bunny, [&fine, &coarse], &poses);
    core(&mut criterion, &mut table, &fine, &poses);
    clusterings(&mut table, &bunny, &poses);
    interlocked(&mut criterion, &mut table, &bunny, &fine);
    against_points(&mut criterion, &mut table, &bunny, &poses);
    against_triangles(&mut criterion, &mut table);
    criterion.final_summary();
    table.write();
}

fn asset(mesh: &Mesh, options: &BuildOptions) -> Asset<'static> {
    build(mesh, options, &|_| ()).expect("a sound mesh").asset
}

/// A bunny with so many points as a shell.
fn shell(mesh: &Mesh, points: u32) -> Arc<Asset<'static>> {
    Arc::new(asset(mesh, &bunny_options(PointCount::About(points))))
}

/// The pointshell on the ground, which is an exact box or a voxelmap.
fn vps(mesh: &Mesh, shell: &Arc<Asset<'static>>, ground: Option<Density>) -> Prepared {
    let scene = Scene {
        body: mesh,
        ground: Ground::Cuboid(GROUND),
    };
    let vps = Vps {
        ground_voxel_size_m: ground.map(|_| 0.005),
        ..Vps::default()
    };
    // The body's is built once for all grounds.
    let assets = |mesh: &Mesh, options: &BuildOptions| {
        Ok(if *options == vps.build_options() {
            shell.clone()
        } else {
            let density = ground.unwrap_or_default();
            Arc::new(asset(mesh, &ground_options(density)))
        })
    };
    vps.prepare_with(&scene, &assets).expect("a sound scene")
}

/// Poses of a bunny that fell on the ground, as VPS has it: in ten runs from different starts, five steps one after
/// the other at 1.5 and at 2.5 seconds, as bodies of the ground's frame.
fn rolling(mesh: &Mesh, shell: &Arc<Asset<'static>>) -> Vec<Pose> {
    let prepared = vps(mesh, shell, None);
    let mut poses = Vec::new();
    for run in 0..10 {
        let mut world = PhysicsWorld {
            narrow_phase: NarrowPhase::with_query_dispatcher(
                VpsDispatcher::default().chain(DefaultQueryDispatcher),
            ),
            gravity: Vector::new(0.0, -10.0, 0.0),
            ..PhysicsWorld::default()
        };
        world.integration_parameters.dt = 1.0 / 200.0;
        let below = Vector::new(0.0, -0.5 * GROUND[1] as f32, 0.0);
        let on_ground = ColliderBuilder::new(prepared.ground.clone());
        world.insert(RigidBodyBuilder::fixed().translation(below), on_ground);
        // Turned by the golden angle from run to run.
        let turn = Rotation::from_scaled_axis(Vector::new(1.0, 0.5, 0.3) * (2.4 * run as f32));
        let body = RigidBodyBuilder::dynamic()
            .pose(Pose::from_parts(Vector::new(0.0, 0.4, 0.0), turn))
            .can_sleep(false);
        let shape = ColliderBuilder::new(prepared.body.clone()).density(200.0);
        let (handle, _) = world.insert(body, shape);
        for step in 0..505 {
            if (300..305).contains(&step) || step >= 500 {
                let mut pose = *world.bodies[handle].position();
                pose.translation -= below;
                poses.push(pose);
            }
            world.step();
        }
    }
    poses
}

/// Something done for all of so many poses.
struct Case<'c> {
    name: &'c str,
    poses: usize,
    run: &'c mut dyn FnMut(),
}

impl<'c> Case<'c> {
    fn new(name: &'c str, poses: usize, run: &'c mut dyn FnMut()) -> Self {
        Self { name, poses, run }
    }
}

/// Seconds for a pose in each case: medians over rounds in which all take their turn, so that a
/// machine that gets slower does so for all.
fn measure<const N: usize>(
    criterion: &mut Criterion,
    group_name: &str,
    mut cases: [Case<'_>; N],
) -> [f64; N] {
    let mut rounds = [[0.0; ROUNDS]; N];
    for round in 0..ROUNDS {
        let group_name = format!("{group_name}_{round}");
        let mut group = criterion.benchmark_group(&group_name);
        group.sampling_mode(SamplingMode::Flat);
        for (Case { name, poses, run }, times) in cases.iter_mut().zip(&mut rounds) {
            group.bench_function(*name, |bencher| bencher.iter(&mut *run));
            let file = target().join(format!("criterion/{group_name}/{name}/new/estimates.json"));
            let estimates = std::fs::read_to_string(file).expect("criterion has written it");
            let estimates: serde_json::Value = serde_json::from_str(&estimates).expect("JSON");
            let ns = estimates["mean"]["point_estimate"]
                .as_f64()
                .expect("a mean");
            times[round] = ns * 1e-9 / *poses as f64;
        }
    }
    rounds.map(|mut times| *times.select_nth_unstable_by(ROUNDS / 2, f64::total_cmp).1)
}

/// The report.
#[derive(Default)]
struct Table {
    text: String,
}

impl Table {
    fn line(&mut self, line: &str) {
        writeln!(self.text, "{line}").expect("memory");
    }

    fn write(&self) {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../reports/queries/README.md");
        write_atomically(&file, self.text.as_bytes()).expect("a place for the report");
        println!("{}", self.text);
    }
}

fn target() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../target")
}

/// Time in the unit that fits.
fn time(seconds: f64) -> String {
    match seconds {
        s if s < 1e-6 => format!("{:.3} µs", s * 1e6),
        s if s < 1e-3 => format!("{:.2} µs", s * 1e6),
        s if s < 1.0 => format!("{:.2} ms", s * 1e3),
        s => format!("{s:.1} s"),
    }
}

/// What an engine asks for, of each algorithm.
fn ground(
    criterion: &mut Criterion,
    table: &mut Table,
    bunny: &Mesh,
    [fine, coarse]: [&Arc<Asset<'static>>; 2],
    poses: &[Pose],
) {
    let scene = Scene {
        body: bunny,
        ground: Ground::Cuboid(GROUND),
    };
    let decomposition = ConvexDecomposition {
        parts: 8,
        vertices: 100,
        resolution: 64,
    };
    let algorithms = [
        ("fine_cuboid", "VPS 35 596, cuboid", vps(bunny, fine, None)),
        (
            "fine_dense",
            "VPS 35 596, dense voxelmap",
            vps(bunny, fine, Some(Density::Dense)),
        ),
        (
            "fine_sparse",
            "VPS 35 596, sparse voxelmap",
            vps(bunny, fine, Some(Density::Sparse)),
        ),
        ("coarse_cuboid", "VPS 799, cuboid", vps(bunny, coarse, None)),
        (
            "coarse_dense",
            "VPS 799, dense voxelmap",
            vps(bunny, coarse, Some(Density::Dense)),
        ),
        (
            "hull",
            "convex hull, 42 points",
            ConvexHull.prepare(&scene).expect("a sound scene"),
        ),
        (
            "decomposition",
            "convex decomposition, 8 parts",
            decomposition.prepare(&scene).expect("a sound scene"),
        ),
        (
            "trimesh",
            "triangle mesh, box",
            Trimesh.prepare(&scene).expect("a sound scene"),
        ),
    ];
    // Every other bunny: triangle meshes take their time.
    let poses: Vec<_> = poses.chunks(10).step_by(2).flatten().copied().collect();
    let mut runs = algorithms.map(|(name, label, prepared)| {
        let poses = &poses;
        // As an engine keeps them, for bodies that go on from pose to pose.
        let run = move || {
            for steps in poses.chunks(5) {
                let mut contacts = Contacts::default();
                for pose in steps {
                    prepared
                        .query(pose, PREDICTION, &mut contacts)
                        .expect("a pair of shapes it knows");
                }
            }
        };
        (name, label, run)
    });
    let cases = runs
        .each_mut()
        .map(|(name, _, run)| Case::new(name, poses.len(), run));
    let seconds = measure(criterion, "ground", cases);
    let [.., hull, decomposition, trimesh] = seconds;
    table.line("# Queries beside parry's\n");
    table.line(
        "Written by `just query-report` (criterion, one core, means over all poses). Poses: ten\n\
         bunnies fallen on the ground, five steps one after the other at 1.5 s and at 2.5 s. What\n\
         stands in one row or is divided takes turns, three rounds of which the median counts;\n\
         other times are no closer than the machine's mood.\n",
    );
    table.line("## Contact manifolds as an engine asks for them, 20 mm ahead\n");
    table.line(
        "| algorithm | a query | triangle mesh / this | decomposition / this | this / hull |",
    );
    table.line("|---|---|---|---|---|");
    for ((_, label, ..), own) in runs.iter().zip(seconds) {
        table.line(&format!(
            "| {label} | {} | {:.0} | {:.2} | {:.1} |",
            time(own),
            trimesh / own,
            decomposition / own,
            own / hull,
        ));
    }
    table.line(
        "\nMust: the fine bunny a thousandth of the triangle mesh and faster than the decomposition,\n\
         the coarse one at most 20 times the hull. Aim: 5000, ten times faster, 5 times. All keep\n\
         from step to step what an engine has them keep. Every other bunny.\n",
    );
}

/// The queries themselves.
fn core(criterion: &mut Criterion, table: &mut Table, fine: &Asset<'_>, poses: &[Pose]) {
    let shell = Shell::new(&fine.tree);
    let maps = [Density::Dense, Density::Sparse].map(|density| {
        let ground = Mesh::cuboid(GROUND).expect("a box");
        let around = Mesh::cuboid(AROUND).expect("a box");
        let options = ground_options(density);
        [asset(&ground, &options), asset(&around, &options)]
    });
    let cuboids = [GROUND, AROUND].map(cuboid);
    let inside: Vec<_> = poses
        .iter()
        .step_by(5)
        .map(|p| Pose::from_parts(-(p.rotation * fine.mass.center()), p.rotation))
        .collect();
    let apart: Vec<_> = poses
        .iter()
        .map(|p| Pose::from_parts(p.translation + Vector::new(0.0, 0.6, 0.0), p.rotation))
        .collect();
    table.line("## Query by query, the bunny of 35 596 points\n");
    table.line("On the ground 20 mm ahead, and without; all points inside of a cube without.\n");
    table.line(
        "| query | cuboid | dense voxelmap | sparse voxelmap | sparse / dense | spheres | points |",
    );
    table.line("|---|---|---|---|---|---|---|");
    let sets: [(&str, &str, usize, &[Pose], f32); 4] = [
        (
            "ground_ahead",
            "on the ground, 20 mm ahead",
            0,
            poses,
            PREDICTION,
        ),
        ("ground", "on the ground", 0, poses, 0.0),
        ("inside", "all inside", 1, &inside, 0.0),
        ("apart", "apart by twice its size", 0, &apart, PREDICTION),
    ];
    for (set, label, which, poses, margin) in sets {
        let [dense, sparse] = [&maps[0][which], &maps[1][which]].map(|a| a.voxelmap.trilinear());
        let cuboid = cuboids[which];
        for (name, what) in QUERIES {
            let query = |field: &dyn RunQuery| {
                for pose in poses {
                    field.run(name, &shell, *pose, margin, None);
                }
            };
            let (mut exact, mut full, mut part) =
                (|| query(&cuboid), || query(&dense), || query(&sparse));
            let group_name = format!("{set}_{name}");
            let [c, d, s] = measure(
                criterion,
                &group_name,
                [
                    Case::new("cuboid", poses.len(), &mut exact),
                    Case::new("dense", poses.len(), &mut full),
                    Case::new("sparse", poses.len(), &mut part),
                ],
            );
            let work = Work::default();
            for pose in poses {
                dense.run(name, &shell, *pose, margin, Some(&work));
            }
            let mean = |n: u64| n as f64 / poses.len() as f64;
            table.line(&format!(
                "| {label}: {what} | {} | {} | {} | {:.2} | {:.0} | {:.0} |",
                time(c),
                time(d),
                time(s),
                s / d,
                mean(work.spheres()),
                mean(work.points()),
            ));
        }
    }
    table.line(
        "\nSpheres and points are those of the dense map. Must: apart 0.2 µs, all inside 1 ms, sparse\n\
         at most 1.3 times dense. Aim: 0.05 µs, 0.2 ms, faster. Segmented by listing is the paper's\n\
         way: all contacts, of which each segment's deepest is kept.\n",
    );
}

const QUERIES: [(&str, &str); 10] = [
    ("touches", "touches"),
    ("deepest", "deepest"),
    ("manifold", "manifold of 4"),
    ("wrench", "force and torque"),
    ("segments_2", "segments, L = 2"),
    ("segments_3", "segments, L = 3"),
    ("segments_4", "segments, L = 4"),
    ("segments_5", "segments, L = 5"),
    ("listed_1", "L = 1 by listing"),
    ("listed_5", "L = 5 by listing"),
];

/// Queries by name, so that each is compiled once for a kind of field.
trait RunQuery {
    fn run(&self, name: &str, shell: &Shell<'_>, pose: Pose, margin: f32, work: Option<&Work>);
}

impl<F: DistanceField> RunQuery for F {
    fn run(&self, name: &str, shell: &Shell<'_>, pose: Pose, margin: f32, work: Option<&Work>) {
        let query = Query::new(shell.tree, self, pose).with_prediction(margin);
        macro_rules! ask {
            ($query:expr) => {{
                let query = $query;
                match name {
                    "touches" => {
                        assert!(query.touches() || margin == 0.0 || pose.translation.y > 0.3)
                    }
                    "deepest" => {
                        black_box(query.deepest());
                    }
                    "manifold" => {
                        black_box(query.manifold::<4>());
                    }
                    "wrench" => {
                        black_box(query.wrench(vps_core::Vec3::ZERO, Weight::Area));
                    }
                    _ => {
                        let level = name.as_bytes()[name.len() - 1] - b'0';
                        let mut sum = 0.0;
                        if name.starts_with("segments") {
                            query.for_each_segment(level.into(), |_, c| sum += c.penetration);
                        } else {
                            sum = listed(&query, &shell.ends[usize::from(level) - 1]);
                        }
                        black_box(sum);
                    }
                }
            }};
        }
        match work {
            None => ask!(query),
            Some(work) => ask!(query.counting(work)),
        }
    }
}

/// The segmented traverse as section 2.4 has it: all contacts are listed, and each replaces that of
/// its segment if it is deeper. `ends` has the first point behind each segment.
fn listed<F: DistanceField, W: vps_core::CountWork>(
    query: &Query<'_, F, W>,
    ends: &[usize],
) -> f32 {
    let mut segment = 0;
    let (mut deepest, mut sum) = (0.0_f32, 0.0);
    query.for_each_contact(|contact| {
        if contact.point_index as usize >= ends[segment] {
            segment += ends[segment..].partition_point(|&end| end <= contact.point_index as usize);
            sum += deepest;
            deepest = 0.0;
        }
        deepest = deepest.max(contact.penetration);
    });
    sum + deepest
}

/// A shell, and for each level the first points behind its segments.
struct Shell<'t> {
    tree: &'t PointSphereTree<'t>,
    ends: Vec<Vec<usize>>,
}

impl<'t> Shell<'t> {
    fn new(tree: &'t PointSphereTree<'t>) -> Self {
        let ends = |level: u32| {
            let end = |cluster| tree.points_below(level, cluster).end;
            tree.level(level).iter().map(end).collect()
        };
        Self {
            tree,
            ends: (1..=tree.level_count()).map(ends).collect(),
        }
    }
}

/// What searches look at, by how the points were put into clusters.
fn clusterings(table: &mut Table, bunny: &Mesh, poses: &[Pose]) {
    let dense = asset(
        &Mesh::cuboid(GROUND).expect("a box"),
        &ground_options(Density::Dense),
    );
    let field = dense.voxelmap.trilinear();
    table.line("## Clusters: bisection, and the paper's bottom-up\n");
    table.line("The fine bunny on the dense map of the ground, 20 mm ahead.\n");
    table.line("| query | spheres, bisection | bottom-up | points, bisection | bottom-up |");
    table.line("|---|---|---|---|---|");
    let trees = [Clustering::Bisect, Clustering::BottomUp { seed: 1 }].map(|clustering| {
        let options = BuildOptions {
            clustering,
            ..bunny_options(PointCount::About(FINE))
        };
        asset(bunny, &options).tree
    });
    for (name, what) in QUERIES {
        let [bisect, bottom_up] = trees.each_ref().map(|tree| {
            let (shell, work) = (Shell::new(tree), Work::default());
            for pose in poses {
                field.run(name, &shell, *pose, PREDICTION, Some(&work));
            }
            [work.spheres(), work.points()].map(|n| n as f64 / poses.len() as f64)
        });
        table.line(&format!(
            "| {what} | {:.0} | {:.0} | {:.0} | {:.0} |",
            bisect[0], bottom_up[0], bisect[1], bottom_up[1]
        ));
    }
    table.line("");
}

/// A shape against itself; nobody asks for its memory.
fn in_itself(shape: SharedShape, dispatcher: Arc<Dispatcher>) -> Prepared {
    Prepared {
        memory: Memory::of_parry(&*shape),
        body: shape.clone(),
        ground: shape,
        dispatcher,
        size: Vec::new(),
        ground_size: Vec::new(),
    }
}

/// Two fine bunnies, one ear in the other.
fn interlocked(
    criterion: &mut Criterion,
    table: &mut Table,
    bunny: &Mesh,
    shell: &Arc<Asset<'static>>,
) {
    let shape: SharedShape = VpsShape::new(shell.clone()).into();
    let vertices: Vec<_> = bunny.vertices().iter().map(|v| v.as_vec3()).collect();
    let mesh = SharedShape::trimesh(vertices, bunny.triangles().to_vec()).expect("triangles");
    // Turned half round and pushed together until some centimetres are shared.
    let poses: Vec<_> = (0..6)
        .map(|i| {
            let turn = Rotation::from_scaled_axis(Vector::new(0.3, 1.0, 0.2) * (1.05 * i as f32));
            Pose::from_parts(Vector::new(0.15, 0.02, 0.05), turn)
        })
        .collect();
    table.line("## Bunny on bunny, interlocked, both fine\n");
    table.line("| algorithm | a query | triangle mesh on triangle mesh / this |\n|---|---|---|");
    let prepared = in_itself(shape, Arc::new(VpsDispatcher::default()));
    let mut contacts = Contacts::default();
    let mut run = || {
        for pose in &poses {
            prepared
                .query(pose, PREDICTION, &mut contacts)
                .expect("VPS shapes");
        }
    };
    let cases = [Case::new("vps", poses.len(), &mut run)];
    let [own] = measure(criterion, "interlocked", cases);
    let theirs = {
        let prepared = in_itself(mesh, Arc::new(DefaultQueryDispatcher));
        // Seconds a query: criterion would take minutes.
        let few = &poses[..2];
        let start = Instant::now();
        for pose in few {
            let mut contacts = Contacts::default();
            prepared
                .query(pose, PREDICTION, &mut contacts)
                .expect("triangle meshes");
        }
        start.elapsed().as_secs_f64() / few.len() as f64
    };
    table.line(&format!("| VPS | {} | {:.0} |", time(own), theirs / own));
    table.line(&format!("| triangle meshes | {} | 1 |", time(theirs)));
    table.line(
        "\nMust: 1000. Aim: 5000. Triangle meshes are asked once, for the first two poses alone.\n",
    );
}

/// The same surface, sampled ever finer.
fn against_points(criterion: &mut Criterion, table: &mut Table, bunny: &Mesh, poses: &[Pose]) {
    let ground = asset(
        &Mesh::cuboid(GROUND).expect("a box"),
        &ground_options(Density::Dense),
    );
    let field = ground.voxelmap.trilinear();
    let poses: Vec<_> = poses.iter().step_by(5).copied().collect();
    table.line("## Time against points, the same poses on the ground, 1 mm ahead\n");
    table.line("| points | all contacts | contacts | ns a contact | deepest | segments, L = 4 | manifold of 4 |");
    table.line("|---|---|---|---|---|---|---|");
    let mut rows: Vec<[f64; 4]> = Vec::new();
    for spacing in [0.0106, 0.00336, 0.00106, 0.000_336] {
        let options = bunny_options(PointCount::Spacing(spacing));
        let tree = asset(bunny, &options).tree;
        let count = tree.point_count();
        let name = format!("points_{count}");
        let queries = || {
            let pose = |p: &Pose| Query::new(&tree, &field, *p).with_prediction(0.001);
            poses.iter().map(pose)
        };
        let sum = std::cell::Cell::new(0.0_f32);
        let add = |contact: Contact| sum.set(sum.get() + contact.penetration);
        let [all, deepest, segments, manifold] = measure(
            criterion,
            &name,
            [
                Case::new("all", poses.len(), &mut || {
                    queries().for_each(|q| q.for_each_contact(add));
                }),
                Case::new("deepest", poses.len(), &mut || {
                    queries().for_each(|q| _ = black_box(q.deepest()));
                }),
                Case::new("segments", poses.len(), &mut || {
                    queries().for_each(|q| q.for_each_segment(4, |_, c| add(c)));
                }),
                Case::new("manifold", poses.len(), &mut || {
                    queries().for_each(|q| _ = black_box(q.manifold::<4>()));
                }),
            ],
        );
        let mut contacts = 0;
        queries().for_each(|q| q.for_each_contact(|_| contacts += 1));
        let contacts = contacts as f64 / poses.len() as f64;
        table.line(&format!(
            "| {count} | {} | {contacts:.0} | {:.0} | {} | {} | {} |",
            time(all),
            all * 1e9 / contacts.max(1.0),
            time(deepest),
            time(segments),
            time(manifold),
        ));
        rows.push([count as f64, deepest, segments, manifold]);
    }
    let (first, last) = (rows[0], rows[rows.len() - 1]);
    let power = |i: usize| (last[i] / first[i]).ln() / (last[0] / first[0]).ln();
    table.line(&format!(
        "\nFrom the first row to the last, time grows like the number of points to the power of {:.2}\n\
         (deepest), {:.2} (segments), {:.2} (manifold). Must: below 0.5. Aim: logarithmic.\n",
        power(1),
        power(2),
        power(3),
    ));
}

/// The same shape and sampling, from ever more triangles.
fn against_triangles(criterion: &mut Criterion, table: &mut Table) {
    let options = BuildOptions {
        resolution: Resolution::VoxelSize(0.01),
        margin: 10,
        points: PointCount::About(10_000),
        ..BuildOptions::default()
    };
    let poses: Vec<_> = (0..50)
        .map(|i| {
            let turn = Rotation::from_scaled_axis(Vector::new(0.7, 0.2, 0.5) * (0.3 * i as f32));
            Pose::from_parts(Vector::new(0.3, 0.3, 0.1), turn)
        })
        .collect();
    table.line("## Time against triangles of the source mesh, a torus in a torus\n");
    table.line("| triangles | points | manifold of 4 | force and torque |\n|---|---|---|---|");
    let tori = [44, 264, 932].map(|detail| {
        let mesh = models::torus(detail);
        (mesh.triangles().len(), asset(&mesh, &options))
    });
    let queries = |torus: &Asset<'_>, run: &dyn Fn(&Query<'_, Trilinear<'_>>)| {
        let field = torus.voxelmap.trilinear();
        for pose in &poses {
            run(&Query::new(&torus.tree, &field, *pose).with_prediction(PREDICTION));
        }
    };
    let mut take_turns = |what: &str, run: &dyn Fn(&Query<'_, Trilinear<'_>>)| {
        let names = tori.each_ref().map(|(triangles, _)| triangles.to_string());
        let mut runs = tori.each_ref().map(|(_, torus)| || queries(torus, run));
        let [a, b, c] = &mut runs;
        let cases = [
            Case::new(&names[0], poses.len(), a),
            Case::new(&names[1], poses.len(), b),
            Case::new(&names[2], poses.len(), c),
        ];
        measure(criterion, &format!("triangles_{what}"), cases)
    };
    let manifold = take_turns("manifold", &|q| _ = black_box(q.manifold::<4>()));
    let wrench = take_turns("wrench", &|q| {
        _ = black_box(q.wrench(vps_core::Vec3::ZERO, Weight::Area));
    });
    for (i, (triangles, torus)) in tori.iter().enumerate() {
        table.line(&format!(
            "| {triangles} | {} | {} | {} |",
            torus.tree.point_count(),
            time(manifold[i]),
            time(wrench[i]),
        ));
    }
    table.line("\nMust: flat within 10 %.");
}
