//! The tables of an experiment, as a run left them.

use std::path::Path;

use crate::data::dataframe;
use crate::data::tables::Tables;
use crate::error::Error;
use crate::experiments::registry::ExperimentFile;
use crate::harness::summarize::MadeWith;
use crate::report::claims::Verdict;

/// The tables of an experiment, and the environment and settings they were made with.
pub(crate) struct Results {
    pub(crate) name: String,
    pub(crate) made_with: MadeWith,
    pub(crate) tables: Tables,
}

impl Results {
    /// Reads the tables in the folder of an experiment.
    pub(crate) fn read(name: &str, folder: &Path) -> Result<Self, Error> {
        let path = folder.join("made_with.json");
        let text = std::fs::read(&path)
            .map_err(|e| format!("{}: {e}: has the experiment been run?", path.display()))?;
        let made_with = serde_json::from_slice(&text)
            .map_err(|e| format!("{}: {e}: run the experiment again", path.display()))?;
        let mut tables = Tables::new();
        for entry in std::fs::read_dir(folder).map_err(|e| format!("{}: {e}", folder.display()))? {
            let path = entry?.path();
            if path.extension().is_some_and(|e| e == "csv")
                && let Some(stem) = path.file_stem()
            {
                tables.insert(stem.to_string_lossy().into_owned(), dataframe::read(&path)?);
            }
        }
        Ok(Self {
            name: name.into(),
            made_with,
            tables,
        })
    }

    /// Judges the claims of `file`, which may be newer than the tables.
    pub(crate) fn verdicts(&self, file: &ExperimentFile) -> Vec<Verdict> {
        file.claim.iter().map(|c| c.judge(&self.tables)).collect()
    }
}
