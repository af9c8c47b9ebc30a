//! A cache of assets on disk.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use vps_core::{Asset, VPS_VERSION};
use xxhash_rust::xxh3::Xxh3;

use crate::error::BuildError;
use crate::file::{FileError, read_asset, write_asset};
use crate::mesh::Mesh;
use crate::options::BuildOptions;
use crate::pipeline::{Stage, build};

/// Identifies this builder: assets of another one may differ.
pub const BUILDER: &str = env!("VPS_BUILDER");

/// A folder of assets, each built once. The key is a hash of vertices, triangles, options, builder and
/// format version.
#[derive(Clone, Debug)]
pub struct AssetCache {
    folder: PathBuf,
}

/// Why a cache cannot provide an asset.
#[derive(Debug, thiserror::Error)]
pub enum CacheError {
    /// The build failed.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// The file cannot be written.
    #[error(transparent)]
    File(#[from] FileError),
}

/// An asset of a cache.
#[derive(Clone, Debug)]
pub struct CachedAsset {
    /// The asset.
    pub asset: Arc<Asset<'static>>,
    /// Its key, 32 hexadecimal digits: the name of its file.
    pub key: String,
    /// Its file.
    pub file: PathBuf,
    /// Size of its file in bytes.
    pub file_bytes: u64,
    /// Build time in seconds, if it was not cached.
    pub build_s: Option<f64>,
}

impl AssetCache {
    /// A cache in a folder, created when needed.
    pub fn new(folder: impl Into<PathBuf>) -> Self {
        Self {
            folder: folder.into(),
        }
    }

    /// The asset of a mesh, read from its file or built now. `progress` is called at the start of each
    /// stage. A damaged file is replaced.
    ///
    /// # Errors
    /// When the build fails, or the file cannot be written.
    pub fn get(
        &self,
        mesh: &Mesh,
        options: &BuildOptions,
        progress: &dyn Fn(Stage),
    ) -> Result<CachedAsset, CacheError> {
        let key = key(mesh, options);
        let path = self.folder.join(format!("{key}.vps"));
        let mut build_s = None;
        let asset = match read_asset(&path) {
            Ok(asset) => asset,
            Err(_) => {
                let start = Instant::now();
                let asset = build(mesh, options, progress)?.asset;
                build_s = Some(start.elapsed().as_secs_f64());
                write_asset(&path, &asset)?;
                asset
            }
        };
        Ok(CachedAsset {
            asset: Arc::new(asset),
            key,
            file_bytes: std::fs::metadata(&path).map_or(0, |m| m.len()),
            file: path,
            build_s,
        })
    }
}

fn key(mesh: &Mesh, options: &BuildOptions) -> String {
    let mut hash = Xxh3::new();
    hash.update(format!("{BUILDER} {VPS_VERSION} {options:?}").as_bytes());
    for vertex in mesh.vertices() {
        for c in vertex.to_array() {
            hash.update(&c.to_le_bytes());
        }
    }
    for v in mesh.triangles().iter().flatten() {
        hash.update(&v.to_le_bytes());
    }
    format!("{:032x}", hash.digest128())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::options::{PointCount, Resolution};

    #[test]
    fn builds_once_and_again_when_damaged_or_asked_for_something_else() {
        let folder = std::env::temp_dir().join(format!("vps-cache-{}", std::process::id()));
        let cache = AssetCache::new(&folder);
        let mesh = Mesh::cuboid([0.2, 0.1, 0.1]).unwrap();
        let options = BuildOptions {
            resolution: Resolution::VoxelsAlongLongest(10),
            points: PointCount::About(50),
            ..BuildOptions::default()
        };
        let get = |options: &BuildOptions| cache.get(&mesh, options, &|_| ()).unwrap();
        let first = get(&options);
        assert!(first.build_s.is_some());
        let again = get(&options);
        assert!(again.build_s.is_none());
        assert_eq!(first.key, again.key);
        assert_eq!(first.asset.to_bytes(), again.asset.to_bytes());
        let other = get(&BuildOptions {
            margin: options.margin + 1,
            ..options.clone()
        });
        assert!(other.build_s.is_some() && other.key != first.key);
        std::fs::write(folder.join(format!("{}.vps", first.key)), b"no asset").unwrap();
        assert!(get(&options).build_s.is_some());
        std::fs::remove_dir_all(folder).unwrap();
    }
}
