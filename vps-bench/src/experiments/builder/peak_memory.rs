//! The peak memory of a build in a process of its own: the command `vps-build`.

use std::path::Path;
use std::process::Command;

use serde_json::Value;

use super::Settings;
use crate::harness::scratch::Scratch;

/// Builds the whole asset of a mesh file and returns the peak memory in bytes.
///
/// # Errors
/// When the command is not beside this program, fails, or cannot tell its memory.
pub(super) fn peak_memory(settings: &Settings, mesh: &Path) -> Result<f64, String> {
    let this = std::env::current_exe().map_err(|e| e.to_string())?;
    let command = this.with_file_name(format!("vps-build{}", std::env::consts::EXE_SUFFIX));
    let scratch = Scratch::new("vps-builder")?;
    let output = Command::new(&command)
        .args(["build", "--json"])
        .args(["--scale", &settings.scale.to_string()])
        .args(["--voxel-size", &settings.voxel_size_m.to_string()])
        .args(["--margin", &settings.margin.to_string()])
        .args(["--points", &settings.points.to_string()])
        .arg(mesh)
        .arg("-o")
        .arg(scratch.path().join("asset.vps"))
        .output()
        .map_err(|e| format!("{}: {e}: `just build` makes it", command.display()))?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).trim().into());
    }
    let summary: Value = serde_json::from_slice(&output.stdout).map_err(|e| e.to_string())?;
    let bytes = summary["peak_memory_bytes"].as_f64();
    bytes.ok_or_else(|| "the system does not tell the peak memory of a process".into())
}
