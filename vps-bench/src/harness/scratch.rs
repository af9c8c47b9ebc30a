//! A folder that is gone afterwards.

use std::path::{Path, PathBuf};

/// A folder of the system's temporary ones.
pub(crate) struct Scratch(PathBuf);

impl Scratch {
    /// A new one; `name` tells those of a process apart.
    pub(crate) fn new(name: &str) -> Result<Self, String> {
        let path = std::env::temp_dir().join(format!("{name}-{}", std::process::id()));
        std::fs::create_dir_all(&path).map_err(|e| format!("{}: {e}", path.display()))?;
        Ok(Self(path))
    }

    pub(crate) fn path(&self) -> &Path {
        &self.0
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        // What cannot be removed lies in the system's own temporary folder.
        let _ = std::fs::remove_dir_all(&self.0);
    }
}
