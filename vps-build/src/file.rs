//! Files of assets, and atomic writes.

use std::io::{Read, Write};
use std::path::{Path, PathBuf};

use vps_core::{Asset, FormatError};

/// Why a file could not be read or written.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// Input or output failed.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The error of the system.
        source: std::io::Error,
    },
    /// The file is not a valid asset.
    #[error("{}: {source}", path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// The fault.
        source: FormatError,
    },
}

/// Reads a `.vps` file.
///
/// # Errors
/// When the file cannot be read or is not a valid asset.
pub fn read_asset(path: &Path) -> Result<Asset<'static>, FileError> {
    let io = |source| FileError::Io {
        path: path.into(),
        source,
    };
    let mut file = std::fs::File::open(path).map_err(io)?;
    let length = file.metadata().map_err(io)?.len() as usize;
    // The file is used in place, aligned to 8 bytes.
    let mut words = vec![0_u64; length.div_ceil(8)];
    let bytes = &mut bytemuck::cast_slice_mut(&mut words)[..length];
    file.read_exact(bytes).map_err(io)?;
    let asset = Asset::from_bytes(bytes).map_err(|source| FileError::Format {
        path: path.into(),
        source,
    })?;
    Ok(asset.into_owned())
}

/// Writes a `.vps` file atomically.
///
/// # Errors
/// When the file cannot be written.
pub fn write_asset(path: &Path, asset: &Asset<'_>) -> Result<(), FileError> {
    write_atomically(path, &asset.to_bytes())
}

/// Writes a file under a temporary name beside `path`, and renames it once it is complete. Missing
/// folders are created.
///
/// # Errors
/// When the file cannot be written; then nothing is left behind.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), FileError> {
    let io = |source| FileError::Io {
        path: path.into(),
        source,
    };
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder).map_err(io)?;
    }
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(format!(".{}.tmp", std::process::id()));
    let temporary = path.with_file_name(name);
    let written = std::fs::File::create(&temporary)
        .and_then(|mut file| {
            file.write_all(bytes)?;
            file.sync_all()
        })
        .and_then(|()| std::fs::rename(&temporary, path));
    written.map_err(|source| {
        // Report the first error.
        let _ = std::fs::remove_file(&temporary);
        io(source)
    })
}
