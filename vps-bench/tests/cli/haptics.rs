//! The haptic loop.

use crate::project::{Project, column};

const EXPERIMENT: &str = r#"
order = 2
title = "A loop"
paper = "no section"
question = "Does it keep its deadline?"
misleads = "A second is short."

[haptics]
model = "box.obj"
scale = 1.0
seconds = 2
quick_seconds = 1
replays = 1
stiffness_n_m = 1000
angular_stiffness_n_m_per_rad = 2
[haptics.stylus]
points = 500
mass_kg = 0.02
voxel_size_m = 0.01
contact_stiffness_n_m3 = 2e9
[haptics.peg]
points = 500
mass_kg = 0.05
voxel_size_m = 0.002
contact_stiffness_n_m3 = 1e9
"#;

#[test]
fn the_loop_is_run_in_real_time_and_its_forces_are_kept() {
    let project = Project::new("haptics");
    project.write("experiments/loop.toml", EXPERIMENT);
    let said = project.succeeds(&["run", "loop", "--quick"]);
    assert!(said.contains("loop: 5 jobs run, 0 kept"), "{said}");

    let deadlines = project.read("reports/loop/deadlines.csv");
    let scenes = ["nothing", "stylus", "stylus", "peg", "peg"];
    assert_eq!(column(&deadlines, "scene"), scenes);
    assert_eq!(column(&deadlines, "cycles"), ["1000"; 5]);
    let felt = project.read("reports/loop/felt.csv");
    let forces = column(&felt, "force_n_max");
    // In its first second the peg comes to lie on the face of the block.
    let peg = column(&felt, "scene")
        .iter()
        .position(|s| *s == "peg")
        .unwrap();
    assert!(forces[peg].parse::<f64>().unwrap() > 0.5, "{felt}");
    // No more than the coupling gives.
    for force in forces {
        assert!(force.parse::<f64>().unwrap() < 10.01, "{felt}");
    }
    for table in ["collision", "course", "stores"] {
        let path = format!("reports/loop/{table}.csv");
        assert!(project.read(&path).lines().count() > 2, "{table}");
    }

    project.succeeds(&["report"]);
    let report = project.read("reports/report.md");
    for part in [
        "loop/force.svg",
        "loop/collision_time.svg",
        "| nothing | none |",
    ] {
        assert!(report.contains(part), "{part} is missing");
    }
    // A whole run runs longer, and keeps nothing of a quick one.
    let said = project.succeeds(&["run", "loop", "--filter", "nothing"]);
    assert!(said.contains("1 jobs run, 0 kept, 4 left"), "{said}");
}
