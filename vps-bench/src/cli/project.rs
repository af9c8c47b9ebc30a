//! The folders of a project and the files in them.

use std::path::PathBuf;

use crate::config::algorithms::Algorithms;
use crate::error::Error;
use crate::experiments::registry::ExperimentFile;
use crate::harness::model_store::ModelStore;

/// The folders of a project.
pub(super) struct Project {
    pub(super) experiments: PathBuf,
    pub(super) cache: PathBuf,
    pub(super) out: PathBuf,
}

impl Project {
    /// Names of all experiments, by the order their files state.
    pub(super) fn names(&self) -> Result<Vec<String>, Error> {
        let folder = &self.experiments;
        let entries =
            std::fs::read_dir(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
        let mut named = Vec::new();
        for entry in entries {
            let path = entry?.path();
            let stem = path
                .file_stem()
                .unwrap_or_default()
                .to_string_lossy()
                .into_owned();
            let is_list = ["models", "algorithms"].contains(&stem.as_str());
            if path.extension().is_some_and(|e| e == "toml") && !is_list {
                named.push((self.file(&stem)?.order, stem));
            }
        }
        named.sort();
        Ok(named.into_iter().map(|(_, name)| name).collect())
    }

    pub(super) fn file(&self, name: &str) -> Result<ExperimentFile, Error> {
        Ok(ExperimentFile::read(
            &self.experiments.join(format!("{name}.toml")),
        )?)
    }

    pub(super) fn algorithms(&self) -> Result<Algorithms, Error> {
        Ok(Algorithms::read(&self.experiments.join("algorithms.toml"))?)
    }

    pub(super) fn models(&self) -> Result<ModelStore, Error> {
        let list = self.experiments.join("models.toml");
        Ok(ModelStore::read(&list, &self.cache.join("models"))?)
    }

    /// The given names, or those of all experiments that were run.
    pub(super) fn named_or_run(&self, names: &[String]) -> Result<Vec<String>, Error> {
        if !names.is_empty() {
            return Ok(names.to_vec());
        }
        let mut names = self.names()?;
        names.retain(|name| self.out.join(name).join("made_with.json").exists());
        if names.is_empty() {
            return Err(format!("{}: no experiment has been run", self.out.display()).into());
        }
        Ok(names)
    }
}
