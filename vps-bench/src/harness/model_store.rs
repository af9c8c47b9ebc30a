//! Models: found where `models.toml` says, checked, and kept.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use serde::Deserialize;
use sha2::{Digest, Sha256};
use vps_build::{FileError, write_atomically};

use crate::config::{ConfigError, read_toml};
use crate::scratch::Scratch;

/// The models an experiment can name.
pub(crate) struct Models {
    list: BTreeMap<String, Model>,
    list_path: PathBuf,
    folder: PathBuf,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Model {
    #[allow(dead_code, reason = "prose for readers of the file")]
    about: String,
    file: String,
    sha256: String,
    source: Vec<Source>,
}

#[derive(Debug, Deserialize)]
#[serde(untagged)]
enum Source {
    Url(UrlSource),
    Debian(DebianSource),
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct UrlSource {
    url: String,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct DebianSource {
    debian_package: String,
    path: String,
}

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

impl Models {
    /// The models of a list, kept in `folder`.
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

    /// The file of a model, fetched if need be; or of an OBJ file given by its path.
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

/// SHA-256 in hexadecimal digits.
pub(crate) fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes)
        .iter()
        .map(|b| format!("{b:02x}"))
        .collect()
}

impl Source {
    fn name(&self) -> String {
        match self {
            Self::Url(source) => source.url.clone(),
            Self::Debian(source) => format!("Debian package {}", source.debian_package),
        }
    }

    fn fetch(&self) -> Result<Vec<u8>, String> {
        match self {
            Self::Url(source) => source.fetch(),
            Self::Debian(source) => source.fetch(),
        }
    }
}

impl UrlSource {
    fn fetch(&self) -> Result<Vec<u8>, String> {
        let agent = ureq::Agent::config_builder()
            .timeout_connect(Some(Duration::from_secs(10)))
            .timeout_global(Some(Duration::from_secs(120)))
            .build()
            .new_agent();
        let mut response = agent.get(&self.url).call().map_err(|e| e.to_string())?;
        let body = response.body_mut().with_config().limit(1 << 30);
        body.read_to_vec().map_err(|e| e.to_string())
    }
}

impl DebianSource {
    /// Downloads the package without installing it, first with the package lists the system has,
    /// then with new ones of our own: that needs no rights and changes nothing on the system.
    fn fetch(&self) -> Result<Vec<u8>, String> {
        let folder = Scratch::new("vps-fetch")?;
        let timeouts = ["-oAcquire::http::Timeout=10", "-oAcquire::Retries=1"].map(String::from);
        let download = |extra: &[String]| {
            let mut arguments = [timeouts.as_slice(), extra].concat();
            arguments.extend(["download".into(), self.debian_package.clone()]);
            run("apt-get", &arguments, folder.path())
        };
        if download(&[]).is_err() {
            let lists = folder.path().join("lists");
            std::fs::create_dir_all(lists.join("partial")).map_err(|e| e.to_string())?;
            let own_lists = [
                format!("-oDir::State::lists={}", lists.display()),
                format!("-oDir::Cache={}", folder.path().display()),
                "-oDebug::NoLocking=1".into(),
            ];
            let update = [timeouts.as_slice(), &own_lists, &["update".into()]].concat();
            run("apt-get", &update, folder.path())?;
            download(&own_lists)?;
        }
        let entries = std::fs::read_dir(folder.path()).map_err(|e| e.to_string())?;
        let package = entries
            .flatten()
            .map(|entry| entry.path())
            .find(|path| path.extension().is_some_and(|e| e == "deb"))
            .ok_or("apt-get download left no package behind")?;
        let unpack = ["-x".into(), package.display().to_string(), "content".into()];
        run("dpkg-deb", &unpack, folder.path())?;
        let file = folder.path().join("content").join(&self.path);
        std::fs::read(&file).map_err(|e| format!("{} in the package: {e}", self.path))
    }
}

fn run(program: &str, arguments: &[String], folder: &Path) -> Result<(), String> {
    let output = Command::new(program)
        .args(arguments)
        .current_dir(folder)
        .env("LC_ALL", "C")
        .output()
        .map_err(|e| format!("{program}: {e}"))?;
    if output.status.success() {
        return Ok(());
    }
    let errors = String::from_utf8_lossy(&output.stderr);
    let last = errors
        .lines()
        .rfind(|l| l.starts_with("E:"))
        .unwrap_or("failed");
    Err(format!("{program}: {last}"))
}
