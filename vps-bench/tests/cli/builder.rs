//! The builder.

use crate::project::{Project, column};

const EXPERIMENT: &str = r#"
order = 2
title = "Builds"
paper = "no section"
question = "How far off are distances?"
misleads = "A box is simple."

[builder]
model = "box.obj"
scale = 1.0
voxel_size_m = 0.01
points = 500
margin = 8
narrow_margin = 2
subdivisions = 1
builds = 2
quick_builds = 1
samples = 40
band_voxels = 2
voxel_seed = 1
sphere_seed = 2
"#;

#[test]
fn distances_are_within_the_bounds_the_assets_state() {
    let project = Project::new("builder");
    project.write("experiments/builds.toml", EXPERIMENT);
    // The command `vps-build` is not beside this one in every build.
    let said = project.bench(&["run", "builds"]);
    assert!(said.out.contains("builds: 23 jobs run, 0 kept"), "{said:?}");
    if said.code != Some(0) {
        assert!(said.errors.contains("`just build` makes it"), "{said:?}");
        assert_eq!(said.errors.lines().count(), 1, "{said:?}");
    }
    let numbers = |table: &str, name: &str| -> Vec<f64> {
        let table = project.read(&format!("reports/builds/{table}.csv"));
        let cells = column(&table, name).into_iter();
        cells.map(|cell| cell.parse().unwrap()).collect()
    };
    assert_eq!(numbers("assets", "triangles"), [12.0, 48.0]);
    assert_eq!(numbers("assets", "builds"), [2.0, 2.0]);
    for what in ["near", "far"] {
        let bounds = numbers("maps", &format!("{what}_bound_voxels"));
        let errors = numbers("maps", &format!("{what}_error_voxels_max"));
        assert_eq!(bounds.len(), 8);
        for (bound, error) in bounds.iter().zip(errors) {
            assert!(error <= bound + 1e-6, "{what}: {error} is beyond {bound}");
        }
    }
    assert_eq!(numbers("spheres", "spheres"), [40.0]);
    // One of them reaches an edge of the box, which the interpolated field rounds off.
    assert_eq!(numbers("spheres", "wrong_spheres"), [1.0]);
    // The other program agrees.
    let grids = numbers("grids", "near_error_voxels_max");
    assert_eq!(grids.len(), 6);
    assert!(grids.iter().all(|error| *error < 0.1), "{grids:?}");

    project.succeeds(&["report"]);
    let report = project.read("reports/report.md");
    assert!(report.contains("| vps-build, sparse |"), "{report}");
}
