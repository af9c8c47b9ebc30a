//! Assets, built once and kept by what they were made from.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use sha2::{Digest, Sha256};
use vps_build::{BuildError, BuildOptions, FileError, Mesh, build, read_asset, write_asset};
use vps_core::{Asset, VPS_VERSION};

/// Where assets are kept.
pub(crate) struct AssetCache {
    folder: PathBuf,
}

#[derive(Debug, thiserror::Error)]
pub(crate) enum AssetError {
    #[error(transparent)]
    Build(#[from] BuildError),
    #[error(transparent)]
    File(#[from] FileError),
}

/// An asset and what it took.
pub(crate) struct Kept {
    pub(crate) asset: Arc<Asset<'static>>,
    /// Of mesh, options, builder and file version: what the asset is known by.
    pub(crate) key: String,
    /// Size of its file in bytes.
    pub(crate) file_bytes: u64,
    /// Time it took to build, if it was not there.
    pub(crate) build_s: Option<f64>,
}

impl AssetCache {
    pub(crate) fn new(folder: PathBuf) -> Self {
        Self { folder }
    }

    /// The asset of a mesh; built now unless it was before.
    pub(crate) fn get(&self, mesh: &Mesh, options: &BuildOptions) -> Result<Kept, AssetError> {
        let key = key(mesh, options);
        let path = self.folder.join(format!("{key}.vps"));
        let mut build_s = None;
        // A damaged file is as good as none.
        let asset = match read_asset(&path) {
            Ok(asset) => asset,
            Err(_) => {
                let start = Instant::now();
                let asset = build(mesh, options, &|_| ())?.asset;
                build_s = Some(start.elapsed().as_secs_f64());
                write_asset(&path, &asset)?;
                asset
            }
        };
        let file_bytes = std::fs::metadata(&path).map_or(0, |m| m.len());
        Ok(Kept {
            asset: Arc::new(asset),
            key,
            file_bytes,
            build_s,
        })
    }
}

fn key(mesh: &Mesh, options: &BuildOptions) -> String {
    let mut hash = Sha256::new();
    let builder = env!("VPS_BUILDER");
    hash.update(format!("{builder} {VPS_VERSION} {options:?}"));
    for vertex in mesh.vertices() {
        for c in vertex.to_array() {
            hash.update(c.to_le_bytes());
        }
    }
    for v in mesh.triangles().iter().flatten() {
        hash.update(v.to_le_bytes());
    }
    let digest = hash.finalize();
    digest[..16].iter().map(|b| format!("{b:02x}")).collect()
}
