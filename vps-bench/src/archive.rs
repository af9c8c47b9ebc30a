//! What a run leaves behind: raw rows as CSV, with units in the names of columns.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize, de::DeserializeOwned};
use vps_build::{FileError, write_atomically};

/// One step of one simulation.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub(crate) struct StepRow {
    pub(crate) algorithm: String,
    /// Which of the random start orientations, from 0.
    pub(crate) orientation: u32,
    pub(crate) step: u32,
    pub(crate) time_s: f64,
    /// Collision queries of this step; 0 while the boxes of the bodies are apart.
    pub(crate) queries: u64,
    /// Time they took.
    pub(crate) query_ns: u64,
    /// Contact points given to the engine.
    pub(crate) contacts: usize,
    /// The deepest of them, negative if none touches yet.
    pub(crate) penetration_m: Option<f32>,
    /// How deep the mesh really is at the pose that was asked about.
    pub(crate) true_penetration_m: f32,
    /// Of the centre of mass, after the step.
    pub(crate) linear_velocity_m_s: f32,
    pub(crate) kinetic_energy_j: f32,
    /// Pose that was asked about.
    pub(crate) x_m: f32,
    pub(crate) y_m: f32,
    pub(crate) z_m: f32,
    pub(crate) qx: f32,
    pub(crate) qy: f32,
    pub(crate) qz: f32,
    pub(crate) qw: f32,
}

/// One simulation.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub(crate) struct JobRow {
    pub(crate) algorithm: String,
    pub(crate) orientation: u32,
    /// `ok`, or why there are no steps of this job.
    pub(crate) status: String,
    pub(crate) simulate_s: f64,
}

/// What an algorithm made from the mesh.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub(crate) struct PreparationRow {
    pub(crate) algorithm: String,
    /// `ok`, or why the algorithm cannot be used.
    pub(crate) status: String,
    /// All of it, with reading what an earlier run built.
    pub(crate) prepare_s: f64,
    /// Building of assets, unless an earlier run did.
    pub(crate) asset_build_s: Option<f64>,
    /// Such as `799 points, 5 levels`.
    pub(crate) size: String,
    /// What its assets are known by, body and ground.
    pub(crate) assets: String,
    /// Size of their files.
    pub(crate) asset_bytes: u64,
}

#[derive(Debug, thiserror::Error)]
pub(crate) enum RecordError {
    #[error("{}: {source}", path.display())]
    Csv { path: PathBuf, source: csv::Error },
    #[error(transparent)]
    File(#[from] FileError),
}

pub(crate) fn write<R: Serialize>(path: &Path, rows: &[R]) -> Result<(), RecordError> {
    let csv_error = |source| RecordError::Csv {
        path: path.into(),
        source,
    };
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in rows {
        writer.serialize(row).map_err(csv_error)?;
    }
    let bytes = writer
        .into_inner()
        .map_err(|e| csv_error(e.into_error().into()))?;
    Ok(write_atomically(path, &bytes)?)
}

pub(crate) fn read<R: DeserializeOwned>(path: &Path) -> Result<Vec<R>, RecordError> {
    let csv_error = |source| RecordError::Csv {
        path: path.into(),
        source,
    };
    let mut reader = csv::Reader::from_path(path).map_err(csv_error)?;
    let rows: Result<_, _> = reader.deserialize().collect();
    rows.map_err(csv_error)
}
