//! The command as its users meet it: a whole small run, and everything that can be wrong.

use std::fs;
use std::io::{Read, Write};
use std::net::TcpListener;
use std::path::PathBuf;
use std::process::Command;

/// A closed box of 0.2 x 0.1 x 0.3 units.
const BOX: &str = "\
v -0.1 -0.05 -0.15\nv 0.1 -0.05 -0.15\nv -0.1 0.05 -0.15\nv 0.1 0.05 -0.15\n\
v -0.1 -0.05 0.15\nv 0.1 -0.05 0.15\nv -0.1 0.05 0.15\nv 0.1 0.05 0.15\n\
f 1 5 7 3\nf 2 4 8 6\nf 1 2 6 5\nf 3 7 8 4\nf 1 3 4 2\nf 5 6 8 7\n";

const EXPERIMENT: &str = r#"
title = "A box falls"
paper = "no section"
about = "A test."
[body]
model = "box"
scale = 1.0
mass_kg = 1.0
friction = 0.5
restitution = 0.0
[ground]
extents_m = [1.0, 0.1, 1.0]
[world]
frequency_hz = 200.0
gravity_m_s2 = 10.0
drop_height_m = 0.3
prediction_m = 0.01
steps = 300
[runs]
orientations = 2
seed = 7
measured_steps = [200, 300]
[quick]
orientations = 1
[[algorithm]]
name = "vps_fine"
label = "VPS"
[algorithm.method.vps]
points = 800
branching = 4
voxel_size_m = 0.01
margin = 4
sampling = "trilinear"
ground_voxel_size_m = 0.02
[[algorithm]]
name = "vps_cuboid"
label = "VPS on a cuboid"
[algorithm.method.vps]
points = 800
branching = 8
voxel_size_m = 0.01
margin = 4
sampling = "local"
[[algorithm]]
name = "hull"
label = "hull"
method = "convex_hull"
[[algorithm]]
name = "parts"
label = "parts"
[algorithm.method.convex_decomposition]
parts = 2
vertices = 100
resolution = 32
[[algorithm]]
name = "trimesh"
label = "triangles"
method = "trimesh"
[[paper_value]]
algorithm = "hull"
query_us = 1.0
source = "nowhere"
"#;

/// A folder of experiments, gone afterwards.
struct Project(PathBuf);

impl Project {
    fn new(name: &str) -> Self {
        let folder = std::env::temp_dir().join(format!("vps-bench-{name}-{}", std::process::id()));
        fs::create_dir_all(folder.join("experiments")).unwrap();
        let project = Self(folder);
        project.write("box.obj", BOX);
        project.write(
            "experiments/fall.toml",
            &EXPERIMENT.replace("\"box\"", "\"box.obj\""),
        );
        project.write("experiments/models.toml", "");
        project
    }

    fn write(&self, name: &str, text: &str) {
        fs::write(self.0.join(name), text).unwrap();
    }

    fn read(&self, name: &str) -> String {
        fs::read_to_string(self.0.join(name)).unwrap()
    }

    fn bench(&self, arguments: &[&str]) -> (Option<i32>, String) {
        let output = Command::new(env!("CARGO_BIN_EXE_vps-bench"))
            .args(arguments)
            .current_dir(&self.0)
            .output()
            .unwrap();
        (
            output.status.code(),
            String::from_utf8(output.stderr).unwrap(),
        )
    }

    /// The command must fail with one line that says all of this.
    fn fails(&self, arguments: &[&str], expected: &[&str]) {
        let (code, message) = self.bench(arguments);
        assert_eq!(code, Some(2), "{message}");
        assert_eq!(message.lines().count(), 1, "{message}");
        for part in expected {
            assert!(message.contains(part), "`{part}` is missing: {message}");
        }
    }
}

impl Drop for Project {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// Columns of a CSV file by name.
fn column<'t>(csv: &'t str, name: &str) -> Vec<&'t str> {
    let mut lines = csv.lines();
    let at = lines
        .next()
        .unwrap()
        .split(',')
        .position(|c| c == name)
        .unwrap();
    lines.map(|line| line.split(',').nth(at).unwrap()).collect()
}

#[test]
fn a_run_leaves_records_tables_and_figures() {
    let project = Project::new("run");
    let (code, message) = project.bench(&["run", "fall"]);
    assert_eq!((code, message.as_str()), (Some(0), ""));
    let steps = project.read("reports/fall/steps.csv");
    assert_eq!(steps.lines().count(), 1 + 5 * 2 * 300);
    for name in [
        "query_time.svg",
        "query_time.png",
        "linear_velocity.svg",
        "linear_velocity.png",
    ] {
        assert!(
            project
                .0
                .join("reports/fall")
                .join(name)
                .metadata()
                .unwrap()
                .len()
                > 1000
        );
    }
    let jobs = project.read("reports/fall/jobs.csv");
    assert!(column(&jobs, "status").iter().all(|s| *s == "ok"), "{jobs}");
    // All lie on the ground in the end, and none is deep in it.
    let summary = project.read("reports/fall/summary.csv");
    assert_eq!(
        column(&summary, "algorithm"),
        ["vps_fine", "vps_cuboid", "hull", "parts", "trimesh"]
    );
    for depth in column(&summary, "true_penetration_mm_max") {
        assert!(depth.parse::<f64>().unwrap() < 15.0, "{summary}");
    }
    for (queries, mean) in column(&summary, "queries")
        .iter()
        .zip(column(&summary, "query_us_mean"))
    {
        assert_eq!(*queries, "200");
        assert!(mean.parse::<f64>().unwrap() > 0.0);
    }
    let environment = project.read("reports/fall/environment.json");
    for key in [
        "\"processor\"",
        "\"rapier3d\": \"0.",
        "\"contact_recycling\": false",
        "\"model_sha256\"",
    ] {
        assert!(environment.contains(key), "{key} is missing");
    }
    // The report can be made again from the records alone, and put into another file.
    let report = project.read("reports/fall/report.md");
    project.write("page.md", "a <!-- fall -->old<!-- /fall --> b");
    let (code, message) = project.bench(&["report", "fall", "--splice", "page.md"]);
    assert_eq!((code, message.as_str()), (Some(0), ""));
    assert_eq!(project.read("reports/fall/report.md"), report);
    assert!(project.read("page.md").contains("| VPS on a cuboid |"));
    assert!(!project.read("page.md").contains("old"));

    // A second run moves every body the same way.
    let (code, _) = project.bench(&["run", "fall", "--out", "again"]);
    assert_eq!(code, Some(0));
    let again = project.read("again/fall/steps.csv");
    for name in [
        "x_m",
        "y_m",
        "z_m",
        "qw",
        "kinetic_energy_j",
        "contacts",
        "penetration_m",
    ] {
        assert!(
            column(&steps, name) == column(&again, name),
            "{name} differs"
        );
    }
    // Nothing half-written stays behind.
    let left = fs::read_dir(project.0.join("reports/fall")).unwrap();
    let names: Vec<_> = left
        .map(|e| e.unwrap().file_name().into_string().unwrap())
        .collect();
    assert!(names.iter().all(|n| !n.contains("tmp")), "{names:?}");
}

#[test]
fn what_is_wrong_is_said_in_one_line() {
    let project = Project::new("wrong");
    project.fails(
        &["run", "missing"],
        &["experiments/missing.toml", "No such file"],
    );
    let wrong = |from: &str, to: &str| {
        let text = project.read("experiments/fall.toml").replace(from, to);
        project.write("experiments/wrong.toml", &text);
    };
    wrong("mass_kg", "weight");
    project.fails(&["run", "wrong"], &["wrong.toml:8: ", "`weight`"]);
    wrong("points = 800", "pints = 800");
    project.fails(&["run", "wrong"], &["wrong.toml:", "`pints`"]);
    wrong("seed = 7", "seed = ");
    project.fails(&["run", "wrong"], &["wrong.toml:21: "]);
    wrong("mass_kg = 1.0", "mass_kg = -1.0");
    project.fails(&["run", "wrong"], &["wrong.toml: ", "body.mass_kg"]);
    wrong("[200, 300]", "[200, 900]");
    project.fails(&["run", "wrong"], &["runs.measured_steps"]);
    wrong("name = \"hull\"", "name = \"parts\"");
    project.fails(&["run", "wrong"], &["`parts`"]);
    project.fails(
        &["run", "fall", "--model", "none.obj"],
        &["none.obj", "models.toml"],
    );
    project.write("nan.obj", &BOX.replace("v 0.1 0.05 0.15", "v 0.1 inf 0.15"));
    project.fails(
        &["run", "fall", "--model", "nan.obj"],
        &["nan.obj:8: `inf`"],
    );
    project.write("flat.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    project.fails(
        &["run", "fall", "--model", "flat.obj"],
        &["flat.obj", "not closed"],
    );
    project.fails(
        &["run", "fall", "--model", "box.obj", "--scale", "0"],
        &["scale"],
    );
    project.fails(
        &["report", "fall"],
        &["environment.json", "has the experiment been run?"],
    );
    assert!(!project.0.join("reports").exists());
}

#[test]
fn an_algorithm_that_fails_gives_a_row_and_the_rest_goes_on() {
    let project = Project::new("row");
    let text = project.read("experiments/fall.toml").replacen(
        "voxel_size_m = 0.01",
        "voxel_size_m = 1e-6",
        1,
    );
    project.write("experiments/fall.toml", &text);
    let (code, message) = project.bench(&["run", "fall", "--quick"]);
    assert_eq!(code, Some(1), "{message}");
    assert!(message.contains("vps_fine: ") && message.contains("choose larger voxels"));
    let preparations = project.read("reports/fall/preparations.csv");
    assert!(
        preparations.contains("choose larger voxels"),
        "{preparations}"
    );
    let jobs = project.read("reports/fall/jobs.csv");
    assert_eq!(
        column(&jobs, "algorithm"),
        ["vps_cuboid", "hull", "parts", "trimesh"]
    );
}

/// Serves `body` once on the loopback interface and gives its address.
fn serve_once(body: &'static str) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap();
    std::thread::spawn(move || {
        let (mut stream, _) = listener.accept().unwrap();
        let mut request = [0; 4096];
        let _ = stream.read(&mut request).unwrap();
        let length = body.len();
        let head =
            format!("HTTP/1.1 200 OK\r\nContent-Length: {length}\r\nConnection: close\r\n\r\n");
        stream.write_all(head.as_bytes()).unwrap();
        stream.write_all(body.as_bytes()).unwrap();
    });
    format!("http://{address}/box.obj")
}

fn models(sha256: &str, urls: &[&str]) -> String {
    let sources: String = urls
        .iter()
        .map(|url| format!("[[box.source]]\nurl = \"{url}\"\n"))
        .collect();
    format!("[box]\nabout = \"a box\"\nfile = \"box.obj\"\nsha256 = \"{sha256}\"\n{sources}")
}

/// SHA-256 of [`BOX`], from `sha256sum`.
const BOX_SHA256: &str = "48f5ec06dd0e1ad5b52164d929d4c2312e0fa599a5718c5cb6cbb497574123a1";

/// A port nothing listens on.
const NOBODY: &str = "http://127.0.0.1:9/box.obj";

#[test]
fn models_are_fetched_in_order_checked_and_kept() {
    let project = Project::new("fetch");
    let address = serve_once(BOX);
    project.write(
        "experiments/models.toml",
        &models(BOX_SHA256, &[NOBODY, &address]),
    );
    let (code, message) = project.bench(&["fetch"]);
    assert_eq!((code, message.as_str()), (Some(0), ""));
    assert_eq!(project.read(".cache/models/box.obj"), BOX);
    // From now on no source is asked.
    assert_eq!(project.bench(&["fetch", "box"]).0, Some(0));
    project.write(".cache/models/box.obj", "v 0 0 0\n");
    project.fails(
        &["fetch"],
        &["box.obj: SHA-256 is", BOX_SHA256, "remove the file"],
    );
}

#[test]
fn wrong_and_unreachable_models_are_refused() {
    let project = Project::new("refuse");
    let address = serve_once("v 6 6 6\n");
    project.write(
        "experiments/models.toml",
        &models(BOX_SHA256, &[NOBODY, &address]),
    );
    let by_hand = ".cache/models/box.obj";
    project.fails(
        &["fetch"],
        &[NOBODY, &address, "refused", by_hand, BOX_SHA256],
    );
    assert!(!project.0.join(by_hand).exists());
    project.fails(&["fetch", "cow"], &["`cow`", "models.toml"]);
    project.write(
        "experiments/models.toml",
        "[box]\nabout = \"\"\nfile = \"b\"\nsha = \"1\"\n",
    );
    project.fails(&["fetch"], &["models.toml:4: ", "`sha`"]);
}
