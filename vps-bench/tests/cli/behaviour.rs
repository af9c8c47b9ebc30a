//! Scenes in rapier worlds.

use crate::project::{Project, column};

const EXPERIMENT: &str = r#"
order = 2
title = "Scenes"
paper = "no section"
question = "Do bodies do what they should?"
misleads = "A box is no bunny."

[behaviour]
segments_level = 2
recycling_mm = 2
other_recycling_mm = [0]
starts = 2
varied = ["vps"]

[behaviour.models]
bunny = "box.obj"
bunny_scale = 1.0
bunny_voxel_size_m = 0.01
bunny_points = 2000
bunny_coarse_points = 500
bunny_parts = 2
parts = 2
part_vertices = 50
decomposition_resolution = 20

[behaviour.scenes.rest]
about = "A box falls and comes to rest."
colliders = ["vps_coarse", "vps", "vps_segments", "decomposition", "trimesh"]
limits = { speed_mm_s = { at_most = 1 }, deepest_mm = { at_most = 20 } }

[behaviour.scenes.bounce]
about = "A ball bounces."
colliders = ["vps"]
has_one_start = true
limits = { height_ratio = { at_least = 0.2, at_most = 0.3 } }

[[claim]]
name = "rests"
says = "A box comes to rest"
value = { table = "scenes", row = { scene = "rest", algorithm = "vps", recycling_mm = "2" }, column = "passed" }
at_least = 1
expect = "holds"
"#;

#[test]
fn scenes_are_judged_by_their_limits_without_being_played_again() {
    let project = Project::new("behaviour");
    let file = "experiments/scenes.toml";
    project.write(file, EXPERIMENT);
    let said = project.succeeds(&["run", "scenes"]);
    // Five colliders rest, and VPS three times more; the ball bounces, and without recycling too.
    assert!(said.contains("scenes: 10 jobs run, 0 kept"), "{said}");

    let scenes = project.read("reports/scenes/scenes.csv");
    let expected = [
        "vps_coarse",
        "vps",
        "vps",
        "vps_segments",
        "decomposition",
        "trimesh",
        "vps",
        "vps",
    ];
    assert_eq!(column(&scenes, "algorithm"), expected);
    assert_eq!(column(&scenes, "complete"), ["1"; 8]);
    assert_eq!(column(&scenes, "starts")[1], "2");
    assert_eq!(column(&scenes, "passed")[1], "1", "{scenes}");
    assert_eq!(column(&scenes, "passed")[6], "1", "{scenes}");
    let starts = project.read("reports/scenes/starts.csv");
    assert_eq!(column(&starts, "start").len(), 10);
    assert!(project.succeeds(&["check"]).contains("scenes/rests: holds"));

    project.succeeds(&["report"]);
    let report = project.read("reports/report.md");
    for part in [
        "A box falls and comes to rest.\n\nRest:",
        "convex decomposition",
    ] {
        assert!(report.contains(part), "{part} is missing");
    }

    // Limits are no input of a job.
    project.edit(file, file, "at_least = 0.2,", "at_least = 0.29,");
    let said = project.succeeds(&["run", "scenes"]);
    assert!(said.contains("scenes: 0 jobs run, 10 kept"), "{said}");
    let scenes = project.read("reports/scenes/scenes.csv");
    assert_eq!(column(&scenes, "passed")[6], "0", "{scenes}");

    // A limit of a quantity that no scene has is no limit.
    project.edit(file, file, "height_ratio", "height");
    let expected = ["behaviour.scenes.bounce.limits", "`height`"];
    project.fails(2, &["run", "scenes"], &expected);
}

#[test]
fn a_quick_run_plays_each_scene_once() {
    let project = Project::new("behaviour-quick");
    project.write("experiments/scenes.toml", EXPERIMENT);
    let said = project.succeeds(&["run", "scenes", "--quick"]);
    assert!(said.contains("scenes: 6 jobs run, 0 kept"), "{said}");
}
