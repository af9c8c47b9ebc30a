//! The models of `models.toml`: file, checksum and sources of each.

use serde::Deserialize;

/// A mesh file and where it comes from.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Model {
    #[allow(dead_code, reason = "prose for readers of the file")]
    about: String,
    pub(crate) file: String,
    pub(crate) sha256: String,
    pub(crate) source: Vec<Source>,
}

/// A source of a model; sources are tried in order.
#[derive(Debug, Deserialize)]
#[serde(untagged)]
pub(crate) enum Source {
    Url(UrlSource),
    Debian(DebianSource),
}

/// An HTTPS address.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct UrlSource {
    pub(crate) url: String,
}

/// A file in a Debian package.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct DebianSource {
    pub(crate) debian_package: String,
    pub(crate) path: String,
}
