//! Experiments as TOML files.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

/// Why a TOML file is no experiment (or no list of models).
#[derive(Debug, thiserror::Error)]
pub(crate) enum ConfigError {
    #[error("{}: {source}", path.display())]
    Io {
        path: PathBuf,
        source: std::io::Error,
    },
    #[error("{}:{line}: {what}", path.display())]
    Toml {
        path: PathBuf,
        line: usize,
        what: String,
    },
    #[error("{}: {what}", path.display())]
    Value { path: PathBuf, what: String },
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
            what: error.message().replace('\n', ", "),
        }
    })
}

/// An experiment in which a body falls on the ground.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Experiment {
    pub(crate) title: String,
    pub(crate) paper: String,
    pub(crate) about: String,
    pub(crate) body: Body,
    pub(crate) ground: Ground,
    pub(crate) world: World,
    pub(crate) runs: Runs,
    pub(crate) quick: Quick,
    pub(crate) algorithm: Vec<Algorithm>,
    #[serde(default)]
    pub(crate) paper_value: Vec<PaperValue>,
}

#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Body {
    /// A name in `models.toml` or the path of an OBJ file.
    pub(crate) model: String,
    /// Metres a unit of the file is long.
    pub(crate) scale: f64,
    pub(crate) mass_kg: f32,
    pub(crate) friction: f32,
    pub(crate) restitution: f32,
}

#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Ground {
    pub(crate) extents_m: [f64; 3],
}

#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct World {
    pub(crate) frequency_hz: f32,
    pub(crate) gravity_m_s2: f32,
    /// Of the centre of mass above the ground.
    pub(crate) drop_height_m: f32,
    pub(crate) prediction_m: f32,
    pub(crate) steps: u32,
}

#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Runs {
    /// Random start orientations.
    pub(crate) orientations: u32,
    pub(crate) seed: u64,
    /// The first step that counts, and the one after the last.
    pub(crate) measured_steps: [u32; 2],
}

/// What a quick run does in place of [`Runs`].
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Quick {
    pub(crate) orientations: u32,
}

#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Algorithm {
    /// In records.
    pub(crate) name: String,
    /// In tables and figures.
    pub(crate) label: String,
    pub(crate) method: Method,
}

#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub(crate) enum Method {
    Vps(Vps),
    ConvexHull,
    ConvexDecomposition {
        parts: usize,
        vertices: usize,
        resolution: u32,
    },
    Trimesh,
}

#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Vps {
    pub(crate) points: u32,
    pub(crate) branching: u32,
    pub(crate) voxel_size_m: f64,
    pub(crate) margin: u32,
    pub(crate) sampling: SamplingName,
    /// Voxels of the ground; without them the ground is an exact cuboid.
    pub(crate) ground_voxel_size_m: Option<f64>,
    pub(crate) ground_margin: Option<u32>,
}

#[derive(Clone, Copy, Debug, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum SamplingName {
    Trilinear,
    Local,
}

/// A number the paper prints.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PaperValue {
    pub(crate) algorithm: String,
    pub(crate) query_us: f64,
    /// Where it stands.
    pub(crate) source: String,
}

impl Experiment {
    /// Reads an experiment and checks its values.
    pub(crate) fn read(path: &Path) -> Result<Self, ConfigError> {
        let experiment: Self = read_toml(path)?;
        experiment.check().map_err(|what| ConfigError::Value {
            path: path.into(),
            what,
        })?;
        Ok(experiment)
    }

    fn check(&self) -> Result<(), String> {
        let positive = [
            ("body.mass_kg", self.body.mass_kg),
            ("world.frequency_hz", self.world.frequency_hz),
            ("world.drop_height_m", self.world.drop_height_m),
            ("world.prediction_m", self.world.prediction_m),
        ];
        for (key, value) in positive {
            if !(value > 0.0 && value.is_finite()) {
                return Err(format!("{key} must be positive, not {value}"));
            }
        }
        let not_negative = [
            ("body.friction", self.body.friction),
            ("body.restitution", self.body.restitution),
            ("world.gravity_m_s2", self.world.gravity_m_s2),
        ];
        for (key, value) in not_negative {
            if !(value >= 0.0 && value.is_finite()) {
                return Err(format!("{key} must not be negative, but is {value}"));
            }
        }
        if !self
            .ground
            .extents_m
            .iter()
            .all(|e| *e > 0.0 && e.is_finite())
        {
            return Err("ground.extents_m must all be positive".into());
        }
        let [from, to] = self.runs.measured_steps;
        if from >= to || to > self.world.steps {
            return Err(format!(
                "runs.measured_steps must grow and end by world.steps = {}, but are {from}, {to}",
                self.world.steps
            ));
        }
        if self.runs.orientations == 0 || self.quick.orientations == 0 {
            return Err("runs.orientations and quick.orientations must be at least 1".into());
        }
        if self.algorithm.is_empty() {
            return Err("at least one [[algorithm]] is needed".into());
        }
        for (i, algorithm) in self.algorithm.iter().enumerate() {
            if self.algorithm[..i].iter().any(|a| a.name == algorithm.name) {
                return Err(format!("algorithm.name `{}` stands twice", algorithm.name));
            }
            if let Method::ConvexDecomposition { vertices, .. } = algorithm.method
                && vertices < 42
            {
                return Err("convex_decomposition.vertices must be at least 42".into());
            }
        }
        for value in &self.paper_value {
            if !self.algorithm.iter().any(|a| a.name == value.algorithm) {
                return Err(format!(
                    "paper_value.algorithm `{}` is no algorithm of this experiment",
                    value.algorithm
                ));
            }
        }
        Ok(())
    }

    /// What the paper prints for an algorithm.
    pub(crate) fn paper_value(&self, algorithm: &str) -> Option<&PaperValue> {
        self.paper_value.iter().find(|v| v.algorithm == algorithm)
    }
}
