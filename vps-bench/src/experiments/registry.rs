//! TOML files: reading them, and what all experiments say of themselves.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::claims::Claim;
use crate::experiments::{
    Experiment, accuracy, bounce, drop, replay, scaling, stack, structures, time_critical,
};

/// Why a TOML file cannot be used.
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

/// An experiment as its TOML file says: what it is about, and exactly one table of a kind.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ExperimentFile {
    /// Where it stands in the report, by the order of the paper.
    pub(crate) order: u32,
    pub(crate) title: String,
    /// Section, figures and tables of the paper.
    pub(crate) paper: String,
    /// What it is to answer.
    pub(crate) question: String,
    /// How it could mislead.
    pub(crate) misleads: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    drop: Option<drop::Settings>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    bounce: Option<bounce::Settings>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    stack: Option<stack::Settings>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    time_critical: Option<time_critical::Settings>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    replay: Option<replay::Settings>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    accuracy: Option<accuracy::Settings>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    scaling: Option<scaling::Settings>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    structures: Option<structures::Settings>,
    #[serde(default)]
    pub(crate) claim: Vec<Claim>,
}

impl ExperimentFile {
    /// Reads an experiment and checks its values.
    pub(crate) fn read(path: &Path) -> Result<Self, ConfigError> {
        let file: Self = read_toml(path)?;
        let value_error = |what| ConfigError::Value {
            path: path.into(),
            what,
        };
        file.kind()
            .map_err(value_error)?
            .check()
            .map_err(value_error)?;
        for claim in &file.claim {
            claim.check().map_err(value_error)?;
        }
        Ok(file)
    }

    /// Takes another model, if it is of a kind that has one.
    pub(crate) fn set_model(&mut self, model: &str, scale: Option<f64>) -> Result<(), String> {
        match (&mut self.drop, &mut self.replay, &mut self.structures) {
            (Some(drop), _, _) => drop.set_model(model, scale),
            (_, Some(replay), _) => replay.set_model(model, scale),
            (_, _, Some(structures)) => structures.set_model(model, scale),
            _ => return Err(format!("`{}` has no model to be replaced", self.title)),
        }
        self.kind()?.check()
    }

    /// Its model and how long a unit of it is, if it is of a kind that takes another one.
    pub(crate) fn model(&self) -> Option<(&str, f64)> {
        self.drop
            .as_ref()
            .map(|drop| (drop.model.as_str(), drop.scale))
    }

    /// What is to be done.
    pub(crate) fn kind(&self) -> Result<&dyn Experiment, String> {
        fn kind<E: Experiment>(settings: &Option<E>) -> Option<&dyn Experiment> {
            settings.as_ref().map(|s| s as &dyn Experiment)
        }
        let kinds = [
            ("drop", kind(&self.drop)),
            ("bounce", kind(&self.bounce)),
            ("stack", kind(&self.stack)),
            ("time_critical", kind(&self.time_critical)),
            ("replay", kind(&self.replay)),
            ("accuracy", kind(&self.accuracy)),
            ("scaling", kind(&self.scaling)),
            ("structures", kind(&self.structures)),
        ];
        let names = kinds.map(|(name, _)| format!("[{name}]")).join(", ");
        let mut there = kinds.into_iter().filter_map(|(_, kind)| kind);
        match (there.next(), there.next()) {
            (Some(kind), None) => Ok(kind),
            _ => Err(format!("exactly one table of these is needed: {names}")),
        }
    }
}

/// That a value is a positive number.
pub(crate) fn positive(key: &str, value: f64) -> Result<(), String> {
    if value > 0.0 && value.is_finite() {
        Ok(())
    } else {
        Err(format!("{key} must be positive, not {value}"))
    }
}

/// That a value is a number not below zero.
pub(crate) fn not_negative(key: &str, value: f64) -> Result<(), String> {
    if value >= 0.0 && value.is_finite() {
        Ok(())
    } else {
        Err(format!("{key} must not be negative, but is {value}"))
    }
}
