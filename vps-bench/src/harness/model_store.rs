//! A folder of models: fetched from their sources, verified by checksum, and kept.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use vps_build::{FileError, write_atomically};

use crate::config::models::Model;
use crate::config::toml_file::{ConfigError, read_toml};
use crate::data::checksum::sha256;

/// The models an experiment can name, and the folder that holds their files.
pub(crate) struct ModelStore {
    list: BTreeMap<String, Model>,
    list_path: PathBuf,
    folder: PathBuf,
}

/// Why a model cannot be used.
#[derive(Debug, thiserror::Error)]
pub(crate) enum ModelError {
    #[error(transparent)]
    Config(#[from] ConfigError),
    #[error(transparent)]
    File(#[from] FileError),
    #[error(
        "model `{name}` is neither in {} nor the path of an OBJ file",
        list.display()
    )]
    Unknown { name: String, list: PathBuf },
    #[error(
        "{}: SHA-256 is {found}, but {expected} was expected: remove the file to fetch it again",
        path.display()
    )]
    Checksum {
        path: PathBuf,
        found: String,
        expected: String,
    },
    #[error(
        "model `{name}` could not be fetched: {}. To put it there by hand: {} with SHA-256 {sha256}",
        tried.join("; "), path.display()
    )]
    Unreachable {
        name: String,
        tried: Vec<String>,
        path: PathBuf,
        sha256: String,
    },
    #[error("{}: {source}", path.display())]
    Io {
        path: PathBuf,
        source: std::io::Error,
    },
}

impl ModelStore {
    /// Reads the list of models; their files are kept in `folder`.
    pub(crate) fn read(list_path: &Path, folder: &Path) -> Result<Self, ModelError> {
        Ok(Self {
            list: read_toml(list_path)?,
            list_path: list_path.into(),
            folder: folder.into(),
        })
    }

    /// Names of all models.
    pub(crate) fn names(&self) -> impl Iterator<Item = &str> {
        self.list.keys().map(String::as_str)
    }

    /// The path of a model's file, which is fetched if it is missing; or `name` itself if it is the
    /// path of a mesh.
    pub(crate) fn file(&self, name: &str) -> Result<PathBuf, ModelError> {
        let Some(model) = self.list.get(name) else {
            let path = PathBuf::from(name);
            if path.is_file() {
                return Ok(path);
            }
            return Err(ModelError::Unknown {
                name: name.into(),
                list: self.list_path.clone(),
            });
        };
        let path = self.folder.join(&model.file);
        if path.exists() {
            let bytes = std::fs::read(&path).map_err(|source| ModelError::Io {
                path: path.clone(),
                source,
            })?;
            let found = sha256(&bytes);
            if found == model.sha256 {
                return Ok(path);
            }
            return Err(ModelError::Checksum {
                path,
                found,
                expected: model.sha256.clone(),
            });
        }
        let mut tried = Vec::new();
        for source in &model.source {
            let failed = match source.fetch() {
                Ok(bytes) => {
                    let found = sha256(&bytes);
                    if found == model.sha256 {
                        write_atomically(&path, &bytes)?;
                        return Ok(path);
                    }
                    format!("its SHA-256 is {found}: refused")
                }
                Err(why) => why.lines().collect::<Vec<_>>().join(" "),
            };
            tried.push(format!("{} ({failed})", source.name()));
        }
        Err(ModelError::Unreachable {
            name: name.into(),
            tried,
            path,
            sha256: model.sha256.clone(),
        })
    }
}
