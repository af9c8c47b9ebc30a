//! A whole run.

use crate::project::{JOBS, NAMES, Project, STEPS, column};

/// The columns that must be the same in every run: poses and contacts.
const POSES: [&str; 10] = [
    "queries",
    "contacts",
    "penetration_m",
    "kinetic_energy_j",
    "x_m",
    "y_m",
    "z_m",
    "qx",
    "qy",
    "qw",
];

#[test]
fn a_run_leaves_records_tables_and_what_they_were_made_with() {
    let project = Project::new("run");
    let said = project.succeeds(&["run", "fall"]);
    assert!(said.contains("fall: 8 jobs run, 0 kept"), "{said}");

    let raw = project.files("reports/fall/raw", "csv");
    assert_eq!(raw.len(), JOBS);
    assert_eq!(project.files("reports/fall/raw", "json").len(), JOBS);
    for path in &raw {
        let text = std::fs::read_to_string(path).unwrap();
        assert_eq!(column(&text, "step").len(), STEPS);
    }
    let jobs = project.read("reports/fall/jobs.csv");
    assert_eq!(column(&jobs, "status"), ["ok"; JOBS]);
    // Seed by seed, so that algorithms take turns.
    assert_eq!(column(&jobs, "algorithm"), [NAMES, NAMES].concat());
    let course = project.read("reports/fall/course.csv");
    assert_eq!(column(&course, "step").len(), NAMES.len() * STEPS);

    // All lie on the ground in the end, and none is deep in it.
    let summary = project.read("reports/fall/summary.csv");
    assert_eq!(column(&summary, "algorithm"), NAMES);
    for depth in column(&summary, "true_penetration_mm_max") {
        assert!(depth.parse::<f64>().unwrap() < 15.0, "{summary}");
    }
    for (queries, mean) in column(&summary, "queries")
        .iter()
        .zip(column(&summary, "query_us_mean"))
    {
        // Two starts, 40 steps that count.
        assert_eq!(*queries, "80");
        assert!(mean.parse::<f64>().unwrap() > 0.0);
    }
    let made_with = project.read("reports/fall/made_with.json");
    for key in [
        "\"quick\": false",
        "\"processor\"",
        "\"rapier3d\": \"0.",
        "\"drop_height_m\": 0.2",
        "\"core\"",
    ] {
        assert!(made_with.contains(key), "{key} is missing");
    }
    // Nothing half-written stays behind.
    assert!(project.files("reports/fall", "tmp").is_empty());
    assert!(project.files("reports/fall/raw", "tmp").is_empty());

    // A second run moves every body the same way.
    project.succeeds(&["run", "fall", "--out", "again"]);
    let again = project.files("again/fall/raw", "csv");
    for (a, b) in raw.iter().zip(&again) {
        let [first, second] = [a, b].map(|path| std::fs::read_to_string(path).unwrap());
        for name in POSES {
            let same = column(&first, name) == column(&second, name);
            assert!(same, "{name} differs in {}", b.display());
        }
    }
}

#[test]
fn a_quick_run_has_few_starts() {
    let project = Project::new("quick");
    let said = project.succeeds(&["run", "fall", "--quick"]);
    assert!(said.contains("fall: 4 jobs run, 0 kept"), "{said}");
    let made_with = project.read("reports/fall/made_with.json");
    assert!(made_with.contains("\"quick\": true"));
    // The rest of the whole run is added to it.
    let said = project.succeeds(&["run", "fall"]);
    assert!(said.contains("fall: 4 jobs run, 4 kept"), "{said}");
}

#[test]
fn an_algorithm_that_fails_gives_a_row_and_the_rest_goes_on() {
    let project = Project::new("row");
    let algorithms = "experiments/algorithms.toml";
    let copy = "\n[vps_tiny]\nlabel = \"tiny\"\ncolor = \"#000000\"\n[vps_tiny.method.vps]\n\
        points = 800\nbranching = 4\nvoxel_size_m = 1e-6\nmargin = 4\nsampling = \"trilinear\"\n";
    project.write(algorithms, &(project.read(algorithms) + copy));
    let fall = "experiments/fall.toml";
    project.edit(fall, fall, "\"vps_l2\"", "\"vps_tiny\"");
    let expected = ["fall: vps_tiny: ", "choose larger voxels"];
    project.fails(1, &["run", "fall", "--quick"], &expected);
    let jobs = project.read("reports/fall/jobs.csv");
    let names = ["vps", "vps_tiny", "hull", "trimesh"];
    assert_eq!(column(&jobs, "algorithm"), names);
    assert!(jobs.contains("choose larger voxels"), "{jobs}");
    let summary = project.read("reports/fall/summary.csv");
    assert_eq!(column(&summary, "algorithm"), ["vps", "hull", "trimesh"]);
    // The report says so, and the failed job is tried again.
    project.succeeds(&["report"]);
    assert!(
        project
            .read("reports/report.md")
            .contains("Failed: vps_tiny: ")
    );
    let said = project.bench(&["run", "fall", "--quick"]);
    assert!(said.out.contains("1 jobs run, 3 kept"), "{}", said.out);
}

#[test]
fn an_algorithm_of_the_list_needs_no_entry() {
    let project = Project::new("key");
    let fall = "experiments/fall.toml";
    project.edit(fall, fall, "\"vps_l2\"", "\"convex_decomposition\"");
    project.succeeds(&["run", "fall", "--quick"]);
    let names = ["vps", "convex_decomposition", "hull", "trimesh"];
    let summary = project.read("reports/fall/summary.csv");
    assert_eq!(column(&summary, "algorithm"), names);
    project.succeeds(&["report"]);
    // Its own label in tables, its own colour in figures.
    let report = project.read("reports/report.md");
    assert!(report.contains("| convex decomposition |"), "{report}");
    let figure = project.read("reports/fall/query_time.svg");
    assert!(figure.to_lowercase().contains("#cc79a7"));
    // The label of the file goes before.
    assert!(report.contains("| triangles |") && !report.contains("| triangle mesh |"));
}

#[test]
fn another_model_is_another_run() {
    let project = Project::new("model");
    project.succeeds(&["run", "fall", "--quick"]);
    let arguments = [
        "run", "fall", "--quick", "--model", "box.obj", "--scale", "0.5",
    ];
    let said = project.succeeds(&arguments);
    assert!(said.contains("4 jobs run, 0 kept"), "{said}");
}
