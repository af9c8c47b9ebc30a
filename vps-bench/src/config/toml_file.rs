//! Reading TOML files, with errors that name file and line.

use std::path::{Path, PathBuf};

use serde::Deserialize;

/// Why a TOML file cannot be used.
#[derive(Debug, thiserror::Error)]
pub(crate) enum ConfigError {
    #[error("{}: {source}", path.display())]
    Io {
        path: PathBuf,
        source: std::io::Error,
    },
    #[error("{}:{line}: {message}", path.display())]
    Toml {
        path: PathBuf,
        line: usize,
        message: String,
    },
    #[error("{}: {message}", path.display())]
    Value { path: PathBuf, message: String },
}

/// Reads a TOML file; an error names the line.
pub(crate) fn read_toml<T: for<'de> Deserialize<'de>>(path: &Path) -> Result<T, ConfigError> {
    let text = std::fs::read_to_string(path).map_err(|source| ConfigError::Io {
        path: path.into(),
        source,
    })?;
    toml::from_str(&text).map_err(|error| {
        let start = error.span().map_or(0, |span| span.start).min(text.len());
        ConfigError::Toml {
            path: path.into(),
            line: 1 + text[..start].matches('\n').count(),
            message: error.message().replace('\n', ", "),
        }
    })
}
