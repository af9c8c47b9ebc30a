//! Prepares an algorithm for two meshes.

use std::sync::Arc;

use vps_build::{BuildOptions, Mesh, build};
use vps_compare::{Algorithm, Ground, Prepared, Scene};

use super::args::Args;

/// Prepares an algorithm for two meshes: the first is the ground, the second the body.
pub(super) fn prepare(
    algorithm: &Algorithm,
    args: &Args,
    [ground, body]: [&Mesh; 2],
) -> Result<Prepared, String> {
    let assets = |mesh: &Mesh, options: &BuildOptions| {
        let options = BuildOptions {
            sign: args.meshes.sign.into(),
            memory_limit: args.memory_limit.saturating_mul(1 << 20),
            ..options.clone()
        };
        let built = build(mesh, &options, &|_| ()).map_err(|e| e.to_string())?;
        Ok(Arc::new(built.asset))
    };
    let scene = Scene {
        body,
        ground: Ground::Mesh(ground),
    };
    let prepared = algorithm.prepare_with(&scene, &assets);
    prepared.map_err(|e| e.to_string())
}
