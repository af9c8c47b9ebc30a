//! The two shapes and their pose.

use std::cell::RefCell;
use std::sync::Arc;

use glamx::{DPose3, DVec3};
use rapier3d::math::Pose;
use rapier3d::parry::query::ContactManifold;
use rapier3d::parry::shape::FeatureId;
use vps_build::{BuildOptions, build};
use vps_compare::{CollisionAlgorithm, Sizes, Vps};
use vps_core::{PointSphereTree, Pose3, Vec3};
use vps_rapier::{PairContact, PairEvent, VpsDispatcher, VpsShape};

use super::ExplainArgs;
use crate::command::args::SIZES;
use crate::command::frames::Frames;
use crate::command::problem::{default_prediction, meshes};
use crate::command::{Error, poses};

/// A in its own frame, and B in a pose.
pub(super) struct Scene {
    /// The files of A and B.
    pub(super) files: [String; 2],
    pub(super) poses_file: String,
    /// The row of the pose, counted from 1.
    pub(super) row: usize,
    /// The pose of B in the frame of A, as given.
    pub(super) pose: DPose3,
    pub(super) prediction_m: f64,
    shapes: [VpsShape; 2],
    /// The pose of the asset of B in the frame of the asset of A.
    asset_pose: Pose,
    /// The origin of the asset of A in the frame of mesh A, in metres.
    origin: DVec3,
}

impl Scene {
    pub(super) fn of(args: &ExplainArgs) -> Result<Self, Error> {
        let poses = poses::read(&args.poses)?;
        let poses_file = args.poses.display().to_string();
        let pose = *poses.get(args.row - 1).ok_or_else(|| {
            let (row, count) = (args.row, poses.len());
            format!("--row {row}: the poses of {poses_file} are 1 to {count}")
        })?;
        let meshes = meshes(&args.meshes)?;
        let paths = [&args.meshes.mesh_a, &args.meshes.mesh_b];
        let files = paths.map(|path| path.display().to_string());
        let [a, b] = [(&meshes.a, &files[0]), (&meshes.b, &files[1])].map(|(mesh, file)| {
            let built = build(mesh, &options(args), &|_| ());
            built.map_err(|e| format!("{file}: {e}"))
        });
        let (a, b) = (a?.asset, b?.asset);
        let Frames([in_a, in_b]) = meshes.frames;
        let [of_a, of_b] = [&a, &b].map(|asset| DVec3::from_array(asset.origin));
        let frames = Frames([in_a + of_a, in_b + of_b]);
        let prediction_m = args.prediction;
        Ok(Self {
            files,
            poses_file,
            row: args.row,
            pose,
            prediction_m: prediction_m.unwrap_or_else(|| default_prediction(&meshes)),
            shapes: [a, b].map(|asset| VpsShape::new(Arc::new(asset))),
            asset_pose: frames.to_local(&pose),
            origin: in_a + of_a,
        })
    }

    /// Everything that happens while the contacts are found.
    pub(super) fn events(&self) -> Result<Vec<PairEvent>, Error> {
        let events = RefCell::new(Vec::new());
        let observer = |event| events.borrow_mut().push(event);
        let mut manifolds: Vec<ContactManifold<(), ()>> = Vec::new();
        let [a, b] = &self.shapes;
        let (pose, prediction) = (&self.asset_pose, self.prediction_m as f32);
        VpsDispatcher::default()
            .observe_contact_manifolds(pose, a, b, prediction, &mut manifolds, &observer)
            .map_err(|_| "unsupported")?;
        Ok(events.into_inner())
    }

    /// The tree of the shell of A (the first) or of B.
    pub(super) fn tree(&self, is_first: bool) -> &PointSphereTree<'static> {
        &self.shapes[if is_first { 0 } else { 1 }].asset().tree
    }

    /// A position in the frame of the shell of A or B, in the frame of mesh A in metres.
    pub(super) fn position(&self, is_first: bool, position: Vec3) -> DVec3 {
        self.origin + (self.shell_pose(is_first) * position).as_dvec3()
    }

    /// A direction in the frame of the shell of A or B, in the frame of A.
    pub(super) fn direction(&self, is_first: bool, direction: Vec3) -> Vec3 {
        self.shell_pose(is_first).rotation * direction
    }

    fn shell_pose(&self, is_first: bool) -> Pose3 {
        if is_first {
            Pose3::identity()
        } else {
            self.asset_pose
        }
    }
}

/// Those of the algorithm `vps`.
fn options(args: &ExplainArgs) -> BuildOptions {
    let mut vps = Vps::default();
    vps.set_sizes(&Sizes {
        points: args.points,
        voxels: args.voxels,
        ..SIZES
    });
    BuildOptions {
        sign: args.meshes.sign.into(),
        ..vps.build_options()
    }
}

/// The index of the shell's point that a contact stands for.
pub(super) fn point_index(contact: &PairContact) -> Option<u32> {
    let [first, second] = contact.ids;
    let id = if contact.shell_is_first {
        first
    } else {
        second
    };
    match id.unpack() {
        FeatureId::Vertex(point) => Some(point),
        _ => None,
    }
}

/// The name of a mesh.
pub(super) fn mesh_name(is_first: bool) -> &'static str {
    if is_first { "A" } else { "B" }
}
