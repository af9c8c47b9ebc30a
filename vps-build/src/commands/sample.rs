//! `vps-build sample`: penetration at points of a file.

use std::path::PathBuf;

use clap::Args;
use glamx::DVec3;
use serde::{Deserialize, Serialize};
use vps_build::{read_asset, write_atomically};
use vps_core::{DistanceField, Vec3};

use super::Error;

#[derive(Args)]
pub(crate) struct SampleArgs {
    /// The asset
    file: PathBuf,
    /// A CSV file with the columns x, y and z, in metres in the coordinates of the mesh
    #[arg(long, value_name = "IN.csv")]
    points: PathBuf,
    /// The CSV file of results: `penetration_m` (negative outside) is within `error_bound_m` of the
    /// exact one, and the solid is closer or deeper by no more than `overestimate_bound_m`. Outside of
    /// the grid the distance is a lower bound, and the first of the two grows with it
    #[arg(short, long, value_name = "OUT.csv")]
    output: PathBuf,
}

#[derive(Deserialize)]
struct Point {
    x: f64,
    y: f64,
    z: f64,
}

#[derive(Serialize)]
struct Sampled {
    x: f64,
    y: f64,
    z: f64,
    penetration_m: f32,
    gradient_x: f32,
    gradient_y: f32,
    gradient_z: f32,
    error_bound_m: f32,
    overestimate_bound_m: f32,
}

pub(crate) fn run(args: &SampleArgs) -> Result<(), Error> {
    let asset = read_asset(&args.file)?;
    let field = asset.voxelmap.trilinear();
    let origin = DVec3::from_array(asset.origin);
    let named = |e: &dyn std::fmt::Display| format!("{}: {e}", args.points.display());
    let mut reader = csv::Reader::from_path(&args.points).map_err(|e| named(&e))?;
    let mut writer = csv::Writer::from_writer(Vec::new());
    for (number, row) in (1..).zip(reader.deserialize()) {
        let Point { x, y, z } = row.map_err(|e| named(&e))?;
        let point = (DVec3::new(x, y, z) - origin).as_vec3();
        if !point.is_finite() {
            return Err(named(&format!("row {number} is not finite")).into());
        }
        let penetration_m = field.penetration(point, Vec3::ZERO);
        let gradient = field.inward_direction(point);
        writer.serialize(Sampled {
            x,
            y,
            z,
            penetration_m,
            gradient_x: gradient.x,
            gradient_y: gradient.y,
            gradient_z: gradient.z,
            error_bound_m: field.error_bound_at(point),
            overestimate_bound_m: field.overestimate_bound_at(point),
        })?;
    }
    let bytes = writer.into_inner().map_err(|e| e.into_error())?;
    Ok(write_atomically(&args.output, &bytes)?)
}
