//! Gives the program its compiler and profile, for the environment of its records.

use std::path::Path;
use std::process::Command;

fn main() {
    let rustc = std::env::var("RUSTC").unwrap_or_else(|_| "rustc".into());
    let version = Command::new(rustc).arg("--version").output();
    let version = version.map_or_else(|_| Vec::new(), |output| output.stdout);
    let version = String::from_utf8_lossy(&version);
    println!("cargo::rustc-env=VPS_RUSTC={}", version.trim());
    for variable in ["PROFILE", "OPT_LEVEL", "TARGET"] {
        let value = std::env::var(variable).unwrap_or_default();
        println!("cargo::rustc-env=VPS_{variable}={value}");
    }
    let lock = Path::new("../Cargo.lock");
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed={}", lock.display());
    let lock = std::fs::read_to_string(lock).unwrap_or_default();
    for name in ["rapier3d", "parry3d"] {
        let entry = format!("name = \"{name}\"\nversion = \"");
        let version = lock
            .split(&entry)
            .nth(1)
            .and_then(|rest| rest.split('"').next());
        let version = version.unwrap_or("unknown");
        println!("cargo::rustc-env=VPS_{}={version}", name.to_uppercase());
    }
}
