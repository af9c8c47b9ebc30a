//! The registry of the kinds of experiments, and the TOML file of an experiment.

use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::config::toml_file::{ConfigError, read_toml};
use crate::error::Error;
use crate::experiments::experiment::Experiment;
use crate::experiments::{
    accuracy, behaviour, bounce, builder, drop, haptics, queries, query_profile, replay, scaling,
    stack, structures, time_critical,
};
use crate::report::claims::Claim;

/// Defines [`ExperimentFile`] with a table for each kind: module, TOML key and name are the same.
macro_rules! registry {
    ($($kind:ident),+ $(,)?) => {
        /// An experiment as its TOML file describes it: its subject, and exactly one table of a
        /// kind.
        #[derive(Clone, Debug, Deserialize, Serialize)]
        #[serde(deny_unknown_fields)]
        pub(crate) struct ExperimentFile {
            /// Its position in the report, by the order of the paper.
            pub(crate) order: u32,
            pub(crate) title: String,
            /// Section, figures and tables of the paper.
            pub(crate) paper: String,
            /// The question it answers.
            pub(crate) question: String,
            /// How it could mislead.
            pub(crate) misleads: String,
            /// Whether `reproduce` runs it.
            #[serde(default = "yes")]
            pub(crate) reproduced: bool,
            $(
                #[serde(default, skip_serializing_if = "Option::is_none")]
                $kind: Option<$kind::Settings>,
            )+
            #[serde(default)]
            pub(crate) claim: Vec<Claim>,
        }

        impl ExperimentFile {
            /// The name of each kind, with its settings if the file has them.
            fn kinds(&self) -> Vec<(&'static str, Option<&dyn Experiment>)> {
                vec![$((stringify!($kind), self.$kind.as_ref().map(|s| s as &dyn Experiment))),+]
            }

            /// The settings of each kind, if the file has them.
            fn kinds_mut(&mut self) -> Vec<Option<&mut dyn Experiment>> {
                vec![$(self.$kind.as_mut().map(|s| s as &mut dyn Experiment)),+]
            }
        }
    };
}

registry!(
    drop,
    bounce,
    stack,
    time_critical,
    replay,
    accuracy,
    scaling,
    structures,
    behaviour,
    haptics,
    builder,
    queries,
    query_profile,
);

fn yes() -> bool {
    true
}

impl ExperimentFile {
    /// The settings a job depends on, as JSON: those of the kind without its planning keys.
    pub(crate) fn physics(&self) -> Result<String, Error> {
        let (name, kind) = self.named_kind()?;
        let mut file = serde_json::to_value(self)?;
        let settings = &mut file[name];
        for key in kind.planning_keys() {
            let mut table = &mut *settings;
            let mut last = *key;
            while let Some((name, rest)) = last.split_once('.') {
                (table, last) = (&mut table[name], rest);
            }
            let removed = table.as_object_mut().and_then(|table| table.remove(last));
            removed.ok_or_else(|| format!("no setting `{key}`"))?;
        }
        Ok(settings.to_string())
    }

    /// Reads an experiment and checks its values.
    pub(crate) fn read(path: &Path) -> Result<Self, ConfigError> {
        let file: Self = read_toml(path)?;
        let value_error = |message| ConfigError::Value {
            path: path.into(),
            message,
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

    /// Replaces the model, if the kind has one that can be replaced.
    pub(crate) fn set_model(&mut self, model: &str, scale: Option<f64>) -> Result<(), String> {
        let kinds = self.kinds_mut();
        let is_replaced = kinds
            .into_iter()
            .flatten()
            .any(|kind| kind.replace_model(model, scale));
        if !is_replaced {
            return Err(format!("`{}` has no model to be replaced", self.title));
        }
        self.kind()?.check()
    }

    /// The model and the length of its unit in metres, if the kind states them.
    pub(crate) fn model(&self) -> Option<(&str, f64)> {
        let mut kinds = self.kinds().into_iter();
        kinds.find_map(|(_, kind)| kind?.model())
    }

    /// The settings of the experiment's kind.
    pub(crate) fn kind(&self) -> Result<&dyn Experiment, String> {
        Ok(self.named_kind()?.1)
    }

    fn named_kind(&self) -> Result<(&'static str, &dyn Experiment), String> {
        let kinds = self.kinds();
        let names: Vec<_> = kinds.iter().map(|(name, _)| format!("[{name}]")).collect();
        let mut present = kinds
            .into_iter()
            .filter_map(|(name, kind)| Some((name, kind?)));
        match (present.next(), present.next()) {
            (Some(kind), None) => Ok(kind),
            _ => Err(format!(
                "exactly one table of these is needed: {}",
                names.join(", ")
            )),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_physics_of_every_experiment_is_without_its_planning_keys() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../experiments");
        let mut count = 0;
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if ["models", "algorithms"].contains(&path.file_stem().unwrap().to_str().unwrap()) {
                continue;
            }
            let mut file = ExperimentFile::read(&path).unwrap();
            let physics = file.physics().unwrap();
            let settings: serde_json::Value = serde_json::from_str(&physics).unwrap();
            for key in file.kind().unwrap().planning_keys() {
                let found = settings.pointer(&format!("/{}", key.replace('.', "/")));
                assert_eq!(found, None, "{}: {key}", path.display());
            }
            file.title.push('!');
            assert_eq!(file.physics().unwrap(), physics);
            if file.set_model("another", None).is_ok() {
                assert_ne!(file.physics().unwrap(), physics, "{}", path.display());
            }
            count += 1;
        }
        assert!(count > 10);
    }
}
