//! Poses of B in the frame of A, from a file or at random.

use std::f32::consts::TAU;
use std::path::Path;

use glamx::{DPose3, DQuat, DVec3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rapier3d::math::{Pose, Rotation, Vector};
use vps_build::Mesh;
use vps_compare::oracle::SolidOracle;

use super::Error;

const COLUMNS: [&str; 7] = ["x_m", "y_m", "z_m", "qx", "qy", "qz", "qw"];

/// Largest difference of the length of a rotation from one.
const LENGTH_TOLERANCE: f64 = 1e-3;

/// Reads a CSV file with a pose of the meshes per row.
pub(super) fn read(path: &Path) -> Result<Vec<DPose3>, Error> {
    let name = path.display();
    let bytes = std::fs::read(path).map_err(|e| format!("{name}: {e}"))?;
    let mut reader = csv::ReaderBuilder::new()
        .trim(csv::Trim::All)
        .comment(Some(b'#'))
        .from_reader(bytes.as_slice());
    let at = |error: csv::Error| {
        let line = error.position().map_or(1, csv::Position::line);
        let why = match error.kind() {
            csv::ErrorKind::UnequalLengths {
                expected_len, len, ..
            } => format!("{len} values where the header has {expected_len} columns"),
            csv::ErrorKind::Utf8 { .. } => "not UTF-8 text".into(),
            _ => error.to_string(),
        };
        format!("{name}:{line}: {why}")
    };
    let header = reader.headers().map_err(at)?.clone();
    let mut places = [0; 7];
    for (place, column) in places.iter_mut().zip(COLUMNS) {
        *place = header.iter().position(|h| h == column).ok_or_else(|| {
            let all = COLUMNS.join(",");
            format!("{name}:1: the column `{column}` is missing: the first line must name {all}")
        })?;
    }
    let mut poses = Vec::new();
    for record in reader.records() {
        let record = record.map_err(at)?;
        let line = record.position().map_or(1, csv::Position::line);
        let mut values = [0.0_f64; 7];
        for ((value, place), column) in values.iter_mut().zip(places).zip(COLUMNS) {
            let text = &record[place];
            let number = text.parse().ok().filter(|n: &f64| (*n as f32).is_finite());
            *value = number.ok_or_else(|| {
                format!("{name}:{line}: {column}: `{text}` is not a finite number")
            })?;
        }
        let [x, y, z, qx, qy, qz, qw] = values;
        let rotation = DQuat::from_xyzw(qx, qy, qz, qw);
        let length = rotation.length();
        if (length - 1.0).abs() > LENGTH_TOLERANCE {
            return Err(format!(
                "{name}:{line}: qx, qy, qz, qw is not a rotation: its length must be 1, not {length}"
            )
            .into());
        }
        let translation = DVec3::new(x, y, z);
        poses.push(DPose3::from_parts(translation, rotation.normalize()));
    }
    if poses.is_empty() {
        return Err(format!("{name}: no pose: give at least one row below the header").into());
    }
    Ok(poses)
}

/// Largest number of drawn directions in which the solids do not meet.
const MAX_DRAWS: usize = 1000;

/// Separation of touching solids, relative to the size of both.
const TOUCHING: f64 = 1e-5;

/// Random poses around first contact, between the local frames. Orientation and direction are random; B
/// is moved from afar along the direction to where it first touches A, and then further or back by a
/// distance: that of the i-th of `count` poses is random within the i-th of `count` equal parts of
/// -`spread_m` to `spread_m`.
pub(super) fn random(
    [mesh_a, mesh_b]: [&Mesh; 2],
    oracle: &SolidOracle,
    count: usize,
    seed: u64,
    spread_m: f64,
) -> Result<Vec<Pose>, Error> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let middle = |mesh: &Mesh| {
        let (low, high) = mesh.bounds();
        (low.midpoint(high), 0.5 * (high - low).length())
    };
    let ((center_a, radius_a), (center_b, radius_b)) = (middle(mesh_a), middle(mesh_b));
    let far = radius_a + radius_b;
    let mut poses = Vec::new();
    let mut draws = 0;
    while poses.len() < count {
        draws += 1;
        if draws > MAX_DRAWS + count {
            return Err("no random pose lets the meshes touch: give poses by --poses".into());
        }
        let turn = rotation([rng.random(), rng.random(), rng.random()]);
        let towards = rotation([rng.random(), rng.random(), rng.random()]) * Vector::X;
        let part: f64 = rng.random();
        let at = |away: f64| {
            let center = center_a.as_vec3() + towards * away as f32;
            Pose::from_parts(center - turn * center_b.as_vec3(), turn)
        };
        // Conservative advancement: the solids cannot meet within their separation.
        let mut away = far;
        let touches = loop {
            let separation = oracle.separation(&at(away));
            if separation <= TOUCHING * far {
                break true;
            }
            away -= separation;
            if away < -far {
                break false;
            }
        };
        if touches {
            let share = (poses.len() as f64 + part) / count as f64;
            poses.push(at(away + spread_m * (1.0 - 2.0 * share)));
        }
    }
    Ok(poses)
}

/// A uniformly distributed rotation (Shoemake, 1992).
fn rotation([u, v, w]: [f32; 3]) -> Rotation {
    let (a, b) = ((1.0 - u).sqrt(), u.sqrt());
    let ((sv, cv), (sw, cw)) = ((TAU * v).sin_cos(), (TAU * w).sin_cos());
    Rotation::from_xyzw(a * sv, a * cv, b * sw, b * cw)
}
