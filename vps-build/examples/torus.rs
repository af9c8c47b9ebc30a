//! Builds an asset from a mesh made by code and writes it: `cargo run --example torus -- torus.vps`.

use std::path::PathBuf;

use vps_build::{BuildOptions, PointCount, Resolution, build, models, write_atomically};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = PathBuf::from(std::env::args().nth(1).unwrap_or("torus.vps".into()));
    let options = BuildOptions {
        resolution: Resolution::VoxelsAlongLongest(32),
        points: PointCount::About(500),
        ..BuildOptions::default()
    };
    let built = build(&models::torus(48), &options, &|stage| println!("{stage:?}"))?;
    write_atomically(&file, &built.asset.to_bytes())?;
    let tree = &built.asset.tree;
    println!(
        "{}: {} points in {} levels",
        file.display(),
        tree.point_count(),
        tree.level_count()
    );
    Ok(())
}
