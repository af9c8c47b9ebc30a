//! Preparing the algorithms of `algorithms.toml` for a scene.

use std::cell::RefCell;
use std::time::Instant;

use serde::{Deserialize, Serialize};
use vps_build::{AssetCache, BuildOptions, CachedAsset, Mesh};
use vps_compare::{Algorithm, Prepared, Scene};

/// An algorithm prepared for a body and a ground.
pub(crate) struct PreparedAlgorithm {
    prepared: Result<Prepared, String>,
    pub(crate) preparation: Preparation,
}

impl PreparedAlgorithm {
    /// The prepared scene, or why the algorithm cannot prepare it.
    pub(crate) fn prepared(&self) -> Result<&Prepared, String> {
        self.prepared.as_ref().map_err(Clone::clone)
    }
}

/// Time, size and memory of a preparation.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
pub(crate) struct Preparation {
    /// The whole preparation, including reading cached assets.
    pub(crate) prepare_s: f64,
    /// Building of assets; `None` if all of them were cached.
    pub(crate) asset_build_s: Option<f64>,
    /// Size, such as `799 points, 5 levels`.
    pub(crate) size: String,
    /// Keys of its assets, body and ground.
    pub(crate) assets: String,
    /// Size of the assets' files.
    pub(crate) asset_bytes: u64,
    /// Memory of both shapes, counted or estimated.
    pub(crate) memory_bytes: u64,
}

/// Prepares a scene and takes the time.
pub(super) fn prepare(
    method: &Algorithm,
    scene: &Scene<'_>,
    assets: &AssetCache,
) -> PreparedAlgorithm {
    let used: RefCell<Vec<CachedAsset>> = RefCell::default();
    let get = |mesh: &Mesh, options: &BuildOptions| {
        let cached = assets
            .get(mesh, options, &|_| ())
            .map_err(|e| e.to_string())?;
        let asset = cached.asset.clone();
        used.borrow_mut().push(cached);
        Ok(asset)
    };
    let start = Instant::now();
    let result = method.prepare_with(scene, &get);
    let prepare_s = start.elapsed().as_secs_f64();
    let prepared = result.map_err(|e| e.to_string());
    let size = prepared
        .iter()
        .flat_map(|p| p.size.iter().chain(&p.ground_size));
    let used = used.into_inner();
    let preparation = Preparation {
        prepare_s,
        asset_build_s: used
            .iter()
            .filter_map(|cached| cached.build_s)
            .reduce(|a, b| a + b),
        size: joined(size.map(|(what, n)| format!("{n} {what}"))),
        assets: joined(used.iter().map(|cached| cached.key.clone())),
        asset_bytes: used.iter().map(|cached| cached.file_bytes).sum(),
        memory_bytes: prepared.as_ref().map_or(0, |p| p.memory.bytes as u64),
    };
    PreparedAlgorithm {
        prepared,
        preparation,
    }
}

fn joined(parts: impl Iterator<Item = String>) -> String {
    parts.collect::<Vec<_>>().join(", ")
}
