//! Queries by themselves: their times and their instructions.

use std::process::Command;

use crate::project::{Project, column};

/// Queries of the box in `project`.
const QUERIES: &str = r#"
order = 2
title = "Queries of a box"
paper = "no section"
question = "How long?"
misleads = "A box is simple."
reproduced = false

[queries]
rounds = 2
quick_rounds = 1
measured_ms = 1
algorithms = ["vps", "hull", "trimesh"]
against = ["hull"]
shell = "vps"
trimesh = "trimesh"
first_steps = [80, 100]
steps_in_a_row = 3
around_extents_m = [0.8, 0.8, 0.8]
apart_m = 0.6
point_spacings_m = [0.03, 0.02, 0.01]
points_prediction_m = 0.01

[queries.tori]
details = [16, 24, 32]
voxel_size_m = 0.05
margin = 4
points = 500
poses = 2

[queries.fall]
model = "box.obj"
scale = 1.0
mass_kg = 1.0
friction = 0.5
restitution = 0.0
ground_extents_m = [1.0, 0.1, 1.0]
gravity_m_s2 = 10.0
drop_height_m = 0.2
prediction_m = 0.01
duration_s = 0.6
measured_s = [0.0, 0.6]
frequencies_hz = [200]
orientations = 2
quick_orientations = 1
seed = 7
algorithms = ["vps"]
show = []

[[claim]]
name = "apart_is_cheaper"
says = "Bodies that are apart cost less"
value = { table = "slowest", row = { case = "inside" }, column = "dense_us" }
against = { table = "slowest", row = { case = "apart" }, column = "dense_us" }
at_least = 1
expect = "holds"
"#;

const PROFILE: &str = r#"
order = 3
title = "Instructions of a box"
paper = "no section"
question = "How many?"
misleads = "A box is simple."
reproduced = false

[query_profile]
model = "box.obj"
scale = 1.0
shell = "vps"
ground_extents_m = [1.0, 0.1, 1.0]
around_extents_m = [0.8, 0.8, 0.8]
poses = 3
depth_m = 0.001
prediction_m = 0.01
repeats = 2
"#;

fn project(name: &str) -> Project {
    let project = Project::new(name);
    project.write("experiments/queries.toml", QUERIES);
    project.write("experiments/profile.toml", PROFILE);
    project
}

fn numbers(csv: &str, name: &str) -> Vec<f64> {
    let values = column(csv, name).into_iter();
    values.map(|value| value.parse().unwrap()).collect()
}

#[test]
fn every_query_is_timed_in_every_field() {
    let project = project("queries");
    let said = project.succeeds(&["run", "queries"]);
    // Twice 3 algorithms, 4 x 3 fields, the interlocked shell, 3 spacings and 3 tori; once the
    // interlocked triangle mesh and 2 clusterings.
    assert!(said.contains("queries: 47 jobs run, 0 kept"), "{said}");

    let fields = project.read("reports/queries/fields.csv");
    assert_eq!(column(&fields, "query").len(), 40);
    for name in ["cuboid_us", "dense_us", "sparse_us", "sparse_by_dense"] {
        assert!(numbers(&fields, name).iter().all(|n| *n > 0.0), "{fields}");
    }
    let cases = column(&fields, "case");
    let spheres = numbers(&fields, "spheres");
    let points = numbers(&fields, "points");
    let queries = column(&fields, "query");
    for i in 0..cases.len() {
        assert!(spheres[i] >= 1.0);
        // Force and torque need every point of a shell that is inside.
        if (cases[i], queries[i]) == ("inside", "wrench") {
            assert!(points[i] > 700.0, "{fields}");
        }
        if cases[i] == "apart" {
            assert_eq!((spheres[i], points[i]), (1.0, 0.0), "{fields}");
        }
    }

    let manifolds = project.read("reports/queries/manifolds.csv");
    let algorithms = ["vps", "hull", "trimesh", "vps", "trimesh"];
    assert_eq!(column(&manifolds, "algorithm"), algorithms);
    let clusterings = project.read("reports/queries/clusterings.csv");
    assert!(
        numbers(&clusterings, "bisect_spheres")
            .iter()
            .all(|n| *n >= 1.0)
    );
    assert!(
        numbers(&clusterings, "bottom_up_spheres")
            .iter()
            .all(|n| *n >= 1.0)
    );

    let sizes = project.read("reports/queries/sizes.csv");
    let of_query = |case: &str, query: &str| -> Vec<f64> {
        let all = column(&sizes, "case")
            .into_iter()
            .zip(column(&sizes, "query"));
        let all = all.zip(numbers(&sizes, "size"));
        all.filter(|(key, _)| *key == (case, query))
            .map(|(_, size)| size)
            .collect()
    };
    assert_eq!(of_query("triangles", "wrench"), [256.0, 576.0, 1024.0]);
    let by_points = of_query("points", "deepest");
    assert!(by_points.len() == 3 && by_points.is_sorted(), "{sizes}");

    project.succeeds(&["report"]);
    let report = project.read("reports/report.md");
    for part in [
        "| hull |",
        "force and torque",
        "queries/points.svg",
        "**holds**",
    ] {
        assert!(report.contains(part), "{part} is missing");
    }
}

#[test]
fn reproduce_leaves_out_what_is_not_to_be_reproduced() {
    let project = project("queries-left-out");
    project.succeeds(&["reproduce", "--quick"]);
    assert!(project.path("reports/fall").exists());
    assert!(!project.path("reports/queries").exists());
    assert!(!project.path("reports/profile").exists());
}

#[test]
fn instructions_are_counted_and_compared() {
    if Command::new("valgrind").arg("--version").output().is_err() {
        return;
    }
    let project = project("profile");
    let said = project.succeeds(&["list"]);
    assert!(said.contains("profile                 11 jobs"), "{said}");
    for out in ["a", "b"] {
        let said = project.succeeds(&["run", "profile", "--quick", "--out", out]);
        assert!(said.contains("profile: 3 jobs run"), "{said}");
    }
    let profile = project.read("a/profile/profile.csv");
    assert_eq!(column(&profile, "query"), ["deepest"; 3]);
    assert_eq!(column(&profile, "field"), ["cuboid", "dense", "sparse"]);
    let compare = ["compare", "a", "b", "--within", "2"];
    let said = project.succeeds(&compare);
    assert!(
        said.contains("| profile | deepest sparse | instructions |"),
        "{said}"
    );

    // A query that takes more instructions than allowed is named.
    let row = profile.lines().nth(1).unwrap();
    let mut cells: Vec<_> = row.split(',').map(String::from).collect();
    let instructions: f64 = cells[4].parse().unwrap();
    assert!(instructions > 100.0, "{profile}");
    cells[4] = (instructions * 0.97).round().to_string();
    project.edit(
        "a/profile/profile.csv",
        "a/profile/profile.csv",
        row,
        &cells.join(","),
    );
    let expected = [
        "profile: deepest cuboid: instructions is",
        "in A and",
        "+3.",
    ];
    project.fails(1, &compare, &expected);
}

#[test]
fn without_valgrind_counting_is_unsupported() {
    let project = project("profile-unsupported");
    let output = Command::new(env!("CARGO_BIN_EXE_vps-bench"))
        .args(["run", "profile", "--quick"])
        .current_dir(&project.0)
        .env("PATH", "")
        .output()
        .unwrap();
    let errors = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{errors}");
    assert!(
        errors.contains("unsupported: valgrind is not installed"),
        "{errors}"
    );
}
