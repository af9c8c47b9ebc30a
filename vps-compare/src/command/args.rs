use std::path::PathBuf;

use clap::builder::PossibleValuesParser;
use clap::{Parser, ValueEnum};
use vps_build::Sign;
use vps_compare::{Algorithm, Sizes};

use super::{Error, options};

/// The two meshes.
#[derive(clap::Args)]
pub(super) struct MeshArgs {
    /// One mesh: .obj, .ply, .stl or .off
    pub(super) mesh_a: PathBuf,
    /// The other mesh, which takes the poses
    pub(super) mesh_b: PathBuf,
    /// Length of a unit of mesh A, in metres
    #[arg(long, default_value_t = 1.0)]
    pub(super) scale_a: f64,
    /// Length of a unit of mesh B, in metres
    #[arg(long, default_value_t = 1.0)]
    pub(super) scale_b: f64,
    /// Which side of a face is the inside
    #[arg(long, value_enum, default_value_t = SignName::Auto)]
    pub(super) sign: SignName,
}

/// Compares collision algorithms on two meshes: how fast, how large, how wrong.
///
/// Each algorithm is asked for the contacts of mesh B with mesh A, pose by pose, and its deepest
/// contact is compared with the exact penetration of the two solids.
#[derive(Parser)]
#[command(version)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub(crate) struct Args {
    #[command(flatten)]
    pub(super) meshes: MeshArgs,
    /// A CSV file of poses of B in the frame of A, with the columns x_m, y_m, z_m, qx, qy, qz, qw
    /// [default: random ones]
    #[arg(long, value_name = "POSES.csv")]
    pub(super) poses: Option<PathBuf>,
    /// Number of random poses: orientation and direction are random, and B is moved along the
    /// direction to where it first touches A, and from there evenly up to the spread away from A or
    /// into it
    #[arg(long, value_name = "N", default_value_t = 50, conflicts_with = "poses")]
    pub(super) random: usize,
    /// Seed of the random poses
    #[arg(long, default_value_t = 1, conflicts_with = "poses")]
    pub(super) seed: u64,
    /// Largest distance or depth of random poses, in metres [default: 5 % of the longest side of the
    /// smaller mesh]
    #[arg(long, value_name = "METRES", conflicts_with = "poses")]
    pub(super) spread: Option<f64>,
    /// Prediction: the distance up to which contacts are queried, in metres [default: 2 % of the
    /// longest side of the smaller mesh]
    #[arg(long, value_name = "METRES")]
    pub(super) prediction: Option<f64>,
    /// Depth or distance from which a wrong answer counts, in metres [default:
    /// 0.1 % of the longest side of the smaller mesh]
    #[arg(long, value_name = "METRES")]
    pub(super) tolerance: Option<f64>,
    /// Only this algorithm; may be given several times
    #[arg(long, value_parser = algorithm_names(), value_name = "NAME")]
    pub(super) algorithm: Vec<String>,
    /// An option of an algorithm, as listed above; may be given several times
    #[arg(long, value_name = "NAME.OPTION=VALUE")]
    pub(super) set: Vec<String>,
    /// Points of each pointshell of VPS, to within 2 %
    #[arg(long, default_value_t = SIZES.points)]
    pub(super) points: u32,
    /// Voxels along the longest side of a mesh, of VPS and of parry's voxels
    #[arg(long, default_value_t = SIZES.voxels)]
    pub(super) voxels: u32,
    /// Most parts of a convex decomposition, of up to 100 vertices each
    #[arg(long, default_value_t = SIZES.parts)]
    pub(super) parts: usize,
    /// Most seconds an algorithm may take to prepare and to answer, all poses together; it is ended
    /// then
    #[arg(long, value_name = "SECONDS", default_value_t = 300.0)]
    pub(super) time_limit: f64,
    /// Most memory an algorithm may take, its copies of the meshes included, in MiB; it is ended then
    /// (on Linux)
    #[arg(long, value_name = "MIB", default_value_t = 4096)]
    pub(super) memory_limit: u64,
    /// Most timings of each query; the shortest counts
    #[arg(long, default_value_t = 5)]
    pub(super) repeat: u32,
    /// CSV file with a row for each pose and algorithm
    #[arg(long, value_name = "FILE")]
    pub(super) csv: Option<PathBuf>,
    /// Print the summary as JSON
    #[arg(long)]
    pub(super) json: bool,
    /// The algorithm to work for, in a process that this command has started
    #[arg(long, hide = true, value_parser = algorithm_names(), value_name = "NAME")]
    pub(super) worker: Option<String>,
}

/// Sizes of the algorithms unless others are given.
pub(super) const SIZES: Sizes = Sizes {
    points: 10_000,
    voxels: 100,
    parts: 8,
};

fn algorithm_names() -> PossibleValuesParser {
    PossibleValuesParser::new(options::help(&SIZES))
}

/// Classification of inside and outside, as in `vps-build build`.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum SignName {
    /// By winding numbers, generalised ones if the mesh has more holes than faces
    Auto,
    /// By winding numbers, once neighbours agree and holes are closed
    Winding,
    /// By generalised winding numbers, with holes left open: nothing is exact then
    Generalized,
    /// By a flood fill from outside, whatever the orientation of faces: voxels not reached are inside
    Fill,
}

impl From<SignName> for Sign {
    fn from(name: SignName) -> Self {
        match name {
            SignName::Auto => Self::Auto,
            SignName::Winding => Self::Winding,
            SignName::Generalized => Self::Generalized,
            SignName::Fill => Self::Fill,
        }
    }
}

/// Counts of options by name, of which none may be 0.
pub(super) fn check_counts(counts: &[(&str, u64)]) -> Result<(), Error> {
    match counts.iter().find(|(_, count)| *count == 0) {
        Some((name, _)) => Err(format!("{name} must be at least 1").into()),
        None => Ok(()),
    }
}

/// A length in metres, if there is one.
pub(super) fn check_length(name: &str, length: Option<f64>) -> Result<(), Error> {
    match length {
        Some(length) if !(length >= 0.0 && (length as f32).is_finite()) => {
            Err(format!("{name} must be a length in metres, not {length}").into())
        }
        _ => Ok(()),
    }
}

impl Args {
    /// The algorithms asked for, with their options.
    pub(super) fn algorithms(&self) -> Result<Vec<Algorithm>, Error> {
        let sizes = Sizes {
            points: self.points,
            voxels: self.voxels,
            parts: self.parts,
        };
        Ok(options::algorithms(&self.algorithm, &sizes, &self.set)?)
    }

    pub(super) fn check(&self) -> Result<(), Error> {
        let counts = [
            ("--random", self.random as u64),
            ("--repeat", u64::from(self.repeat)),
            ("--points", u64::from(self.points)),
            ("--voxels", u64::from(self.voxels)),
            ("--parts", self.parts as u64),
            ("--memory-limit", self.memory_limit),
        ];
        check_counts(&counts)?;
        check_length("--spread", self.spread)?;
        check_length("--prediction", self.prediction)?;
        check_length("--tolerance", self.tolerance)?;
        if self.time_limit.is_nan() || self.time_limit <= 0.0 {
            let given = self.time_limit;
            return Err(format!("--time-limit must be positive, not {given}").into());
        }
        Ok(())
    }
}
