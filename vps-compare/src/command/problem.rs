//! The problem: two meshes, poses, and the exact penetrations.

use std::path::Path;

use glamx::DPose3;
use rapier3d::math::Pose;
use vps_build::{ExactSolid, Mesh, read_mesh};
use vps_compare::oracle::{ExactPenetration, SolidOracle};

use super::args::{Args, MeshArgs, SignName};
use super::frames::LocalMeshes;
use super::progress::Progress;
use super::{Error, poses};

/// The inputs that all algorithms share.
pub(super) struct Problem {
    pub(super) meshes: LocalMeshes,
    /// Whether each mesh was a solid without repair.
    pub(super) watertight: [bool; 2],
    /// Spread of random poses.
    pub(super) spread_m: Option<f64>,
    pub(super) prediction_m: f64,
    pub(super) tolerance_m: f64,
    pub(super) poses: Vec<ProblemPose>,
    /// Uncertainty of the exact penetration if its search ended, in metres.
    pub(super) exact_tolerance_m: f64,
    /// Whether A and B were left open, so that no penetration is exact.
    pub(super) is_open: [bool; 2],
}

/// A pose of B in the frame of A.
pub(super) struct ProblemPose {
    /// Between the meshes.
    pub(super) of_meshes: DPose3,
    /// Between their local frames.
    pub(super) local: Pose,
    /// Unless a mesh is open.
    pub(super) exact: Option<ExactPenetration>,
}

/// Defaults, relative to the longest side of the smaller mesh.
const SPREAD: f64 = 0.05;
const PREDICTION: f64 = 0.02;
const TOLERANCE: f64 = 0.001;

impl Problem {
    pub(super) fn of(args: &Args, progress: &Progress) -> Result<Self, Error> {
        let meshes = meshes(&args.meshes)?;
        let LocalMeshes { a, b, frames } = &meshes;
        let read = args.poses.as_deref().map(poses::read).transpose()?;
        progress.set("sorting triangles".into());
        let solid_a = solid(&args.meshes.mesh_a, a, args.meshes.sign)?;
        let solid_b = solid(&args.meshes.mesh_b, b, args.meshes.sign)?;
        let watertight = [&solid_a, &solid_b].map(|solid| solid.repairs().is_none());
        let oracle = SolidOracle::new(solid_a, solid_b);
        let is_open = oracle.is_open();
        let size = size([a, b]);
        let spread_m = args.spread.unwrap_or(SPREAD * size);
        let is_random = read.is_none();
        let poses = match read {
            Some(poses) => {
                let both = |pose| (pose, frames.to_local(&pose));
                poses.into_iter().map(both).collect()
            }
            None => {
                progress.set("moving B to where it touches A".into());
                let local = poses::random([a, b], &oracle, args.random, args.seed, spread_m)?;
                let both = |pose| (frames.to_meshes(&pose), pose);
                local.into_iter().map(both).collect::<Vec<_>>()
            }
        };
        let count = poses.len();
        let exact = |(i, (of_meshes, local)): (usize, (DPose3, Pose))| {
            progress.set(format!("exact penetration of pose {} of {count}", i + 1));
            let is_known = !is_open.contains(&true);
            ProblemPose {
                of_meshes,
                local,
                exact: is_known.then(|| oracle.penetration(&local)),
            }
        };
        Ok(Self {
            watertight,
            spread_m: is_random.then_some(spread_m),
            prediction_m: args
                .prediction
                .unwrap_or_else(|| default_prediction(&meshes)),
            tolerance_m: args.tolerance.unwrap_or(TOLERANCE * size),
            poses: poses.into_iter().enumerate().map(exact).collect(),
            exact_tolerance_m: oracle.tolerance_m(),
            is_open,
            meshes,
        })
    }

    /// Whether an exact penetration is exact enough to measure errors by.
    pub(super) fn is_certain(&self, exact: &ExactPenetration) -> bool {
        exact.uncertainty_m <= self.tolerance_m.max(self.exact_tolerance_m)
    }
}

/// The default prediction in metres.
pub(super) fn default_prediction(meshes: &LocalMeshes) -> f64 {
    PREDICTION * size([&meshes.a, &meshes.b])
}

/// The longest side of the smaller mesh in metres.
fn size(meshes: [&Mesh; 2]) -> f64 {
    let longest = meshes.map(|mesh| {
        let (low, high) = mesh.bounds();
        (high - low).max_element()
    });
    longest[0].min(longest[1])
}

/// A and B.
pub(super) fn meshes(args: &MeshArgs) -> Result<LocalMeshes, Error> {
    let a = mesh(&args.mesh_a, args.scale_a, "--scale-a")?;
    let b = mesh(&args.mesh_b, args.scale_b, "--scale-b")?;
    Ok(LocalMeshes::of([a, b])?)
}

fn mesh(path: &Path, scale: f64, option: &str) -> Result<Mesh, Error> {
    let mesh = read_mesh(path, None)?;
    let scaled = mesh.scaled(scale);
    Ok(scaled.map_err(|e| format!("{}: {option}: {e}", path.display()))?)
}

fn solid(path: &Path, mesh: &Mesh, sign: SignName) -> Result<ExactSolid, Error> {
    let solid = ExactSolid::new(mesh, sign.into());
    Ok(solid.map_err(|e| format!("{}: {e}", path.display()))?)
}
