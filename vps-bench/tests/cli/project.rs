//! A small project in a folder of its own.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A closed box of 0.2 x 0.1 x 0.3 units.
pub(crate) const BOX: &str = "\
v -0.1 -0.05 -0.15\nv 0.1 -0.05 -0.15\nv -0.1 0.05 -0.15\nv 0.1 0.05 -0.15\n\
v -0.1 -0.05 0.15\nv 0.1 -0.05 0.15\nv -0.1 0.05 0.15\nv 0.1 0.05 0.15\n\
f 1 5 7 3\nf 2 4 8 6\nf 1 2 6 5\nf 3 7 8 4\nf 1 3 4 2\nf 5 6 8 7\n";

const ALGORITHMS: &str = r##"
[vps]
label = "VPS"
color = "#0072b2"
[vps.method.vps]
points = 800
branching = 4
voxel_size_m = 0.01
margin = 4
sampling = "trilinear"
ground_voxel_size_m = 0.02

[vps_l2]
label = "VPS <L = 2>"
color = "#2171b5"
like = "vps"
segments = 2

[hull]
label = "hull"
color = "#009e73"
method = "convex_hull"

[trimesh]
label = "triangles"
color = "#56b4e9"
method = "trimesh"
"##;

/// The algorithms of [`EXPERIMENT`], in its order.
pub(crate) const NAMES: [&str; 4] = ["vps", "vps_l2", "hull", "trimesh"];

/// Steps of a job, and jobs of the whole experiment.
pub(crate) const STEPS: usize = 120;
pub(crate) const JOBS: usize = 2 * NAMES.len();

const EXPERIMENT: &str = r#"
order = 1
title = "A box falls"
paper = "no section"
question = "Does a box fall? See `contacts` & others."
misleads = "A box is <simple>."

[drop]
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
measured_s = [0.4, 0.6]
frequencies_hz = [200]
orientations = 2
quick_orientations = 1
seed = 7
algorithms = ["vps", "vps_l2", "hull", "trimesh"]
show = ["query_times", "linear_velocity"]

[[drop.paper_value]]
algorithm = "hull"
query_us = 1.0
source = "nowhere"

[[claim]]
name = "stays_above"
says = "The box stays above the ground"
value = { table = "summary", row = { algorithm = "vps" }, column = "fell_through" }
at_most = 0
expect = "holds"
"#;

/// A folder with one experiment, `fall`, gone afterwards.
pub(crate) struct Project(pub(crate) PathBuf);

/// The output of the command.
#[derive(Debug)]
pub(crate) struct Said {
    pub(crate) code: Option<i32>,
    pub(crate) out: String,
    pub(crate) errors: String,
}

impl Project {
    pub(crate) fn new(name: &str) -> Self {
        let folder = std::env::temp_dir().join(format!("vps-bench-{name}-{}", std::process::id()));
        fs::create_dir_all(folder.join("experiments")).unwrap();
        let project = Self(folder);
        project.write("box.obj", BOX);
        project.write("experiments/fall.toml", EXPERIMENT);
        project.write("experiments/algorithms.toml", ALGORITHMS);
        project.write("experiments/models.toml", "");
        project
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    pub(crate) fn write(&self, name: &str, text: &str) {
        fs::write(self.path(name), text).unwrap();
    }

    pub(crate) fn read(&self, name: &str) -> String {
        let path = self.path(name);
        fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
    }

    /// Replaces a text that must be there, in a file or, with another name, in a copy of it.
    pub(crate) fn edit(&self, name: &str, to: &str, old: &str, new: &str) {
        let text = self.read(name);
        assert!(text.contains(old), "`{old}` is not in {name}");
        self.write(to, &text.replacen(old, new, 1));
    }

    pub(crate) fn bench(&self, arguments: &[&str]) -> Said {
        let output = Command::new(env!("CARGO_BIN_EXE_vps-bench"))
            .args(arguments)
            .current_dir(&self.0)
            .output()
            .unwrap();
        Said {
            code: output.status.code(),
            out: String::from_utf8(output.stdout).unwrap(),
            errors: String::from_utf8(output.stderr).unwrap(),
        }
    }

    /// The command must succeed without a word on standard error; returns its output.
    pub(crate) fn succeeds(&self, arguments: &[&str]) -> String {
        let said = self.bench(arguments);
        let (code, errors) = (said.code, said.errors.as_str());
        assert_eq!((code, errors), (Some(0), ""), "{arguments:?}");
        said.out
    }

    /// The command must succeed and say one line on standard error with all of this; returns its
    /// output.
    pub(crate) fn warns(&self, arguments: &[&str], expected: &[&str]) -> String {
        let said = self.bench(arguments);
        assert_eq!(said.code, Some(0), "{arguments:?}: {}", said.errors);
        assert_eq!(said.errors.lines().count(), 1, "{}", said.errors);
        for part in expected {
            let errors = &said.errors;
            assert!(errors.contains(part), "`{part}` is missing: {errors}");
        }
        said.out
    }

    /// The command must end with a code and one line on standard error that says all of this.
    pub(crate) fn fails(&self, code: i32, arguments: &[&str], expected: &[&str]) {
        let said = self.bench(arguments);
        let message = said.errors;
        assert_eq!(said.code, Some(code), "{arguments:?}: {message}");
        assert_eq!(message.lines().count(), 1, "{message}");
        for part in expected {
            assert!(message.contains(part), "`{part}` is missing: {message}");
        }
    }

    /// The files of a folder with an extension, in order.
    pub(crate) fn files(&self, folder: &str, extension: &str) -> Vec<PathBuf> {
        let entries = fs::read_dir(self.path(folder)).unwrap();
        let mut files: Vec<_> = entries.map(|e| e.unwrap().path()).collect();
        files.retain(|path| path.extension().is_some_and(|e| e == extension));
        files.sort();
        files
    }
}

impl Drop for Project {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// Copies the files of a folder into another.
pub(crate) fn copy_files(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let path = entry.unwrap().path();
        if path.is_file() {
            fs::copy(&path, to.join(path.file_name().unwrap())).unwrap();
        }
    }
}

/// A column of a CSV file by its name.
pub(crate) fn column<'t>(csv: &'t str, name: &str) -> Vec<&'t str> {
    let mut lines = csv.lines();
    let heads = lines.next().unwrap().split(',');
    let at = heads.clone().position(|c| c == name);
    let at = at.unwrap_or_else(|| panic!("no column {name}"));
    lines.map(|line| line.split(',').nth(at).unwrap()).collect()
}
