//! The algorithms of `algorithms.toml`, which experiments refer to by name.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use plotters::style::RGBColor;
use serde::{Deserialize, Serialize};

use crate::config::toml_file::{ConfigError, read_toml};

/// All algorithms by name.
#[derive(Clone, Debug)]
pub(crate) struct Algorithms {
    path: PathBuf,
    list: BTreeMap<String, Algorithm>,
}

/// A collision algorithm with its parameters.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub(crate) struct Algorithm {
    /// Its name in tables and figures.
    pub(crate) label: String,
    /// Its colour in all figures, such as `#0072b2`.
    pub(crate) color: String,
    pub(crate) method: Method,
}

/// An entry of the file, with a method of its own or of another entry.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Entry {
    label: String,
    color: String,
    method: Option<Method>,
    /// An algorithm of the method `vps` that differs from this one only in its manifolds.
    like: Option<String>,
    /// The level whose clusters give a contact each.
    segments: Option<u32>,
}

/// The method of an algorithm, with its parameters.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub(crate) enum Method {
    Vps(Vps),
    /// The native ball of the engine, for the mesh of a ball around its origin.
    Ball,
    ConvexHull,
    ConvexDecomposition {
        parts: usize,
        vertices: usize,
        resolution: u32,
    },
    Trimesh,
    Voxels {
        resolution: u32,
    },
}

/// Parameters of Voxelmap-Pointshell.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Vps {
    pub(crate) points: u32,
    pub(crate) branching: u32,
    pub(crate) voxel_size_m: f64,
    pub(crate) margin: u32,
    pub(crate) sampling: SamplingName,
    /// The level whose clusters give a contact each (section 2.4); without it there are four
    /// contacts that span the largest area.
    pub(crate) segments: Option<u32>,
    /// Voxels of the ground; without them the ground is an exact cuboid.
    pub(crate) ground_voxel_size_m: Option<f64>,
    pub(crate) ground_margin: Option<u32>,
}

/// How a voxelmap is sampled.
#[derive(Clone, Copy, Debug, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum SamplingName {
    Trilinear,
    Local,
}

impl Algorithm {
    /// Its colour, which was checked when it was read.
    pub(crate) fn rgb(&self) -> RGBColor {
        let digits = self.color.trim_start_matches('#');
        let [_, r, g, b] = u32::from_str_radix(digits, 16).unwrap_or(0).to_be_bytes();
        RGBColor(r, g, b)
    }
}

impl Algorithms {
    /// Reads the list.
    pub(crate) fn read(path: &Path) -> Result<Self, ConfigError> {
        let entries: BTreeMap<String, Entry> = read_toml(path)?;
        let resolve = |(name, entry): (&String, &Entry)| {
            let method = entry.resolve(&entries);
            let method = method.map_err(|message| ConfigError::Value {
                path: path.into(),
                message: format!("[{name}]: {message}"),
            })?;
            let algorithm = Algorithm {
                label: entry.label.clone(),
                color: entry.color.clone(),
                method,
            };
            Ok((name.clone(), algorithm))
        };
        Ok(Self {
            path: path.into(),
            list: entries.iter().map(resolve).collect::<Result<_, _>>()?,
        })
    }

    /// The algorithm of a name.
    pub(crate) fn get(&self, name: &str) -> Result<&Algorithm, String> {
        let known = self.list.get(name);
        known.ok_or_else(|| format!("no algorithm `{name}` in {}", self.path.display()))
    }
}

impl Entry {
    fn resolve(&self, all: &BTreeMap<String, Self>) -> Result<Method, String> {
        let color = self.color.strip_prefix('#').filter(|c| c.len() == 6);
        if color.is_none_or(|c| u32::from_str_radix(c, 16).is_err()) {
            return Err(format!("color must be like #0072b2, not {}", self.color));
        }
        let mut method = match (&self.method, &self.like) {
            (Some(method), None) => method.clone(),
            (None, Some(like)) => {
                let other = all.get(like).and_then(|entry| entry.method.clone());
                other.ok_or_else(|| format!("like: `{like}` has no method of its own"))?
            }
            _ => return Err("either method or like is needed".into()),
        };
        match (&mut method, self.segments) {
            (_, None) => {}
            (Method::Vps(vps), Some(level)) if level > 0 => vps.segments = Some(level),
            _ => return Err("segments is a level from 1 on, of the method vps".into()),
        }
        if let Method::ConvexDecomposition { vertices, .. } = method
            && vertices < 42
        {
            return Err("convex_decomposition.vertices must be at least 42".into());
        }
        Ok(method)
    }
}
