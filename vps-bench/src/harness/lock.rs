//! One run at a time in a folder.

use std::fs::{File, TryLockError};
use std::io::{ErrorKind, Read, Write};
use std::path::Path;

use crate::error::Error;

/// The locked file; it holds the number of the process.
const FILE_NAME: &str = ".lock";

/// Held while a run writes into a folder; the system releases it when the process ends, however it
/// ends.
pub(crate) struct FolderLock {
    _file: File,
}

impl FolderLock {
    /// Locks a folder, which is made if it is missing.
    ///
    /// # Errors
    /// If another process holds it.
    pub(crate) fn of(folder: &Path) -> Result<Self, Error> {
        let path = folder.join(FILE_NAME);
        let failed = |e: std::io::Error| format!("{}: {e}", path.display());
        std::fs::create_dir_all(folder).map_err(failed)?;
        let mut options = File::options();
        let options = options.read(true).write(true).create(true).truncate(false);
        let mut file = options.open(&path).map_err(failed)?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                let mut process = String::new();
                // Some systems do not let it be read.
                let _ = file.read_to_string(&mut process);
                return Err(format!(
                    "{}: another run writes there (process {}): wait for its end or choose another \
                     folder by --out",
                    folder.display(),
                    process.trim(),
                )
                .into());
            }
            // A file system without locks.
            Err(TryLockError::Error(e)) if e.kind() == ErrorKind::Unsupported => {}
            Err(TryLockError::Error(e)) => return Err(failed(e).into()),
        }
        file.set_len(0).map_err(failed)?;
        writeln!(file, "{}", std::process::id()).map_err(failed)?;
        Ok(Self { _file: file })
    }
}
