use std::path::PathBuf;

use crate::command::Error;
use crate::command::args::{MeshArgs, SIZES, check_counts, check_length};

/// Explains one answer of VPS: why each contact of B with A was kept or dropped.
///
/// Builds the assets of both meshes as the comparison does for `vps`, asks for the contacts at one pose,
/// and prints what the queries and the contact reduction did: counts for each level of the trees, all
/// events, the contacts that remain, and why the others went.
#[derive(clap::Args)]
pub(crate) struct ExplainArgs {
    #[command(flatten)]
    pub(super) meshes: MeshArgs,
    /// A CSV file of poses of B in the frame of A, with the columns x_m, y_m, z_m, qx, qy, qz, qw
    #[arg(long, value_name = "POSES.csv")]
    pub(super) poses: PathBuf,
    /// Which of the poses, counted from 1
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(super) row: usize,
    /// Prediction: the distance up to which contacts are queried, in metres [default: 2 % of the
    /// longest side of the smaller mesh]
    #[arg(long, value_name = "METRES")]
    pub(super) prediction: Option<f64>,
    /// Points of each pointshell, to within 2 %
    #[arg(long, default_value_t = SIZES.points)]
    pub(super) points: u32,
    /// Voxels along the longest side of a mesh
    #[arg(long, default_value_t = SIZES.voxels)]
    pub(super) voxels: u32,
    /// PLY file with the points of the shells, coloured by what became of them, and the normals of the
    /// contacts that remain, in the frame of A
    #[arg(long, value_name = "FILE")]
    pub(super) ply: Option<PathBuf>,
    /// CSV file with a row for each event
    #[arg(long, value_name = "FILE")]
    pub(super) csv: Option<PathBuf>,
    /// Print counts and contacts as JSON, without the events
    #[arg(long)]
    pub(super) json: bool,
}

impl ExplainArgs {
    pub(super) fn check(&self) -> Result<(), Error> {
        check_counts(&[
            ("--row", self.row as u64),
            ("--points", u64::from(self.points)),
            ("--voxels", u64::from(self.voxels)),
        ])?;
        check_length("--prediction", self.prediction)
    }
}
