//! Folders, meshes and runs of the command, shared by its tests.

use std::fmt::Write;
use std::path::PathBuf;
use std::process::Command;

use vps_build::Mesh;

/// A folder of its own for a test, gone at its end.
pub(crate) struct Folder(PathBuf);

impl Folder {
    pub(crate) fn new(name: &str) -> Self {
        let name = format!("vps-compare-{name}-{}", std::process::id());
        let folder = std::env::temp_dir().join(name);
        std::fs::create_dir_all(&folder).unwrap();
        Self(folder)
    }

    pub(crate) fn path(&self, name: &str) -> String {
        self.0.join(name).to_str().unwrap().to_owned()
    }

    pub(crate) fn write(&self, name: &str, text: &str) -> String {
        std::fs::write(self.0.join(name), text).unwrap();
        self.path(name)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

pub(crate) fn obj(mesh: &Mesh) -> String {
    let mut text = String::new();
    for v in mesh.vertices() {
        writeln!(text, "v {} {} {}", v.x, v.y, v.z).unwrap();
    }
    for t in mesh.triangles() {
        let [a, b, c] = t.map(|v| v + 1);
        writeln!(text, "f {a} {b} {c}").unwrap();
    }
    text
}

/// Exit status, standard output and standard error without the lines of a log, which a slow machine
/// gets.
pub(crate) fn vps_compare(arguments: &[&str]) -> (Option<i32>, String, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_vps-compare"));
    let output = command.args(arguments).output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    let errors = text(output.stderr);
    let errors = errors
        .split_inclusive('\n')
        .filter(|l| !l.contains(" (after "));
    (output.status.code(), text(output.stdout), errors.collect())
}
