//! The algorithms that experiments refer to by name: those of `algorithms.toml` and, by their keys,
//! those of vps-compare with their default options.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use plotters::style::RGBColor;
use serde::Deserialize;
use vps_compare::{Algorithm as Method, Vps};

use crate::config::toml_file::{ConfigError, read_toml};

/// All algorithms by name.
#[derive(Clone, Debug)]
pub(crate) struct Algorithms {
    path: PathBuf,
    list: BTreeMap<String, Algorithm>,
}

/// A collision algorithm as experiments show it.
#[derive(Clone, Debug)]
pub(crate) struct Algorithm {
    /// Its name in tables and figures.
    pub(crate) label: String,
    /// Its colour in all figures.
    color: RGBColor,
    pub(crate) method: Method,
}

/// An entry of the file, with a method of its own or of another entry.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Entry {
    /// That of the method, if there is none.
    label: Option<String>,
    /// A colour such as `#0072b2`; that of the method, if there is none.
    color: Option<String>,
    method: Option<Method>,
    /// An algorithm of the method `vps` that differs from this one only in its manifolds.
    like: Option<String>,
    /// The level whose clusters give a contact each.
    segments: Option<u32>,
}

impl Algorithm {
    /// An algorithm with the label and the colour of its method.
    fn of(method: Method) -> Self {
        let [red, green, blue] = method.color();
        Self {
            label: method.label().into(),
            color: RGBColor(red, green, blue),
            method,
        }
    }

    /// Its colour in all figures.
    pub(crate) fn rgb(&self) -> RGBColor {
        self.color
    }
}

impl Algorithms {
    /// Reads the list. Its names hide the keys of vps-compare.
    pub(crate) fn read(path: &Path) -> Result<Self, ConfigError> {
        let entries: BTreeMap<String, Entry> = read_toml(path)?;
        let by_key = |method: Method| (method.key().to_owned(), Algorithm::of(method));
        let mut list: BTreeMap<_, _> = Method::all().into_iter().map(by_key).collect();
        for (name, entry) in &entries {
            let algorithm = entry.resolve(&entries);
            let algorithm = algorithm.map_err(|message| ConfigError::Value {
                path: path.into(),
                message: format!("[{name}]: {message}"),
            })?;
            list.insert(name.clone(), algorithm);
        }
        Ok(Self {
            path: path.into(),
            list,
        })
    }

    /// The algorithm of a name.
    pub(crate) fn get(&self, name: &str) -> Result<&Algorithm, String> {
        let known = self.list.get(name);
        known.ok_or_else(|| {
            let (path, keys) = (self.path.display(), Method::KEYS.join(", "));
            format!("no algorithm `{name}` in {path}, and it is none of {keys}")
        })
    }

    /// The parameters of an algorithm of the method `vps`.
    pub(crate) fn vps(&self, name: &str) -> Result<&Vps, String> {
        match &self.get(name)?.method {
            Method::Vps(vps) => Ok(vps),
            _ => Err(format!("`{name}` is not of the method vps")),
        }
    }
}

impl Entry {
    fn resolve(&self, all: &BTreeMap<String, Self>) -> Result<Algorithm, String> {
        let mut method = match (&self.method, &self.like) {
            (Some(method), None) => method.clone(),
            (None, Some(like)) => {
                let other = all.get(like).and_then(|entry| entry.method.clone());
                other.ok_or_else(|| format!("like: `{like}` has no method of its own"))?
            }
            _ => return Err("either method or like is needed".into()),
        };
        if self.segments.is_some() {
            let Method::Vps(vps) = &mut method else {
                return Err("segments are of the method vps".into());
            };
            vps.segments = self.segments;
            method.check()?;
        }
        let mut algorithm = Algorithm::of(method);
        if let Some(label) = &self.label {
            algorithm.label.clone_from(label);
        }
        if let Some(color) = &self.color {
            let rgb = rgb(color);
            algorithm.color =
                rgb.ok_or_else(|| format!("color must be like #0072b2, not {color}"))?;
        }
        Ok(algorithm)
    }
}

/// A colour such as `#0072b2`.
fn rgb(color: &str) -> Option<RGBColor> {
    let digits = color.strip_prefix('#').filter(|digits| digits.len() == 6)?;
    let [_, red, green, blue] = u32::from_str_radix(digits, 16).ok()?.to_be_bytes();
    Some(RGBColor(red, green, blue))
}
