//! The algorithms by name, and what they make of the two meshes.

use std::cell::{Cell, RefCell};
use std::sync::Arc;
use std::time::Instant;

use vps_build::{BuildOptions, Mesh, PointCount, Resolution, build};
use vps_compare::{
    CollisionAlgorithm, ConvexDecomposition, ConvexHull, Ground, Prepared, Scene, Trimesh, Voxels,
    Vps, VpsGround,
};
use vps_core::Asset;
use vps_rapier::{Manifolds, Role, Sampling};

use super::args::{Args, Name};
use super::guard::guarded;
use super::setting::Setting;

/// An algorithm that was prepared, or why it could not be.
pub(super) struct Candidate {
    pub(super) name: Name,
    pub(super) prepare_s: f64,
    pub(super) prepared: Result<Prepared, String>,
}

/// Assets and the seconds each took.
pub(super) type Built = RefCell<Vec<(usize, Arc<Asset<'static>>, f64)>>;

/// How an algorithm's parts are found.
const DECOMPOSITION_RESOLUTION: u32 = 64;
/// Most vertices of a convex part.
const PART_VERTICES: usize = 100;

/// Prepares an algorithm; A is the ground, B the body.
pub(super) fn prepare(name: Name, args: &Args, setting: &Setting, built: &Built) -> Candidate {
    let options = BuildOptions {
        resolution: Resolution::VoxelsAlongLongest(args.voxels),
        points: PointCount::About(args.points),
        ..BuildOptions::default()
    };
    // An asset that is there already took as long as it took.
    let saved_s = Cell::new(0.0);
    let assets = |mesh: &Mesh, options: &BuildOptions| {
        let key = std::ptr::from_ref(mesh).addr();
        if let Some((_, asset, build_s)) = built.borrow().iter().find(|b| b.0 == key) {
            saved_s.set(saved_s.get() + build_s);
            return Ok(asset.clone());
        }
        let start = Instant::now();
        let asset = build(mesh, options, &|_| ()).map_err(|e| e.to_string())?;
        let asset = Arc::new(asset.asset);
        let build_s = start.elapsed().as_secs_f64();
        built.borrow_mut().push((key, asset.clone(), build_s));
        Ok(asset)
    };
    let vps = |role| Vps {
        body: options.clone(),
        ground: VpsGround::Asset(options.clone(), role),
        sampling: Sampling::default(),
        manifolds: Manifolds::default(),
        assets: &assets,
    };
    let scene = Scene {
        body: &setting.mesh_b,
        ground: Ground::Mesh(&setting.mesh_a),
    };
    let start = Instant::now();
    let prepared = guarded(|| {
        let prepared = match name {
            Name::Vps => vps(Role::Mixed).prepare(&scene),
            Name::VpsBoth => vps(Role::Both).prepare(&scene),
            Name::ConvexHull => ConvexHull.prepare(&scene),
            Name::ConvexDecomposition => ConvexDecomposition {
                parts: args.parts,
                vertices: PART_VERTICES,
                resolution: DECOMPOSITION_RESOLUTION,
            }
            .prepare(&scene),
            Name::Trimesh => Trimesh.prepare(&scene),
            Name::Voxels => Voxels {
                resolution: args.voxels,
            }
            .prepare(&scene),
        };
        prepared.map_err(|e| e.to_string())
    });
    Candidate {
        name,
        prepare_s: start.elapsed().as_secs_f64() + saved_s.get(),
        prepared,
    }
}
