//! Prepares the algorithms by name.

use std::sync::Arc;

use vps_build::{BuildOptions, Mesh, PointCount, Resolution, build};
use vps_compare::{
    CollisionAlgorithm, ConvexDecomposition, ConvexHull, Ground, Prepared, Scene, Trimesh, Voxels,
    Vps, VpsGround,
};
use vps_rapier::{Manifolds, Role, Sampling};

use super::args::{Args, Name};

/// Resolution of convex decomposition.
const DECOMPOSITION_RESOLUTION: u32 = 64;
/// Largest number of vertices of a convex part.
const PART_VERTICES: usize = 100;

/// Prepares an algorithm for two meshes: the first is the ground, the second the body.
pub(super) fn prepare(
    name: Name,
    args: &Args,
    [ground, body]: [&Mesh; 2],
) -> Result<Prepared, String> {
    let options = BuildOptions {
        resolution: Resolution::VoxelsAlongLongest(args.voxels),
        points: PointCount::About(args.points),
        sign: args.sign.into(),
        memory_limit: args.memory_limit.saturating_mul(1 << 20),
        ..BuildOptions::default()
    };
    let assets = |mesh: &Mesh, options: &BuildOptions| {
        let built = build(mesh, options, &|_| ()).map_err(|e| e.to_string())?;
        Ok(Arc::new(built.asset))
    };
    let vps = |role| Vps {
        body: options.clone(),
        ground: VpsGround::Asset(options.clone(), role),
        sampling: Sampling::default(),
        manifolds: Manifolds::default(),
        assets: &assets,
    };
    let scene = Scene {
        body,
        ground: Ground::Mesh(ground),
    };
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
}
