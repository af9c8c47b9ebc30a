//! The report: made from the small tables of all experiments alone.

mod html;
mod markdown;

use std::path::Path;

use vps_build::write_atomically;

use crate::algorithms::Algorithms;
use crate::claims::{Tables, Verdict};
use crate::config::ExperimentFile;
use crate::experiments::Error;
use crate::frame;
use crate::page::{Block, Section};
use crate::run::MadeWith;

/// Files of the report.
pub(crate) const MARKDOWN: &str = "report.md";
pub(crate) const HTML: &str = "report.html";

/// The tables of an experiment and what they were made with.
pub(crate) struct Results {
    pub(crate) name: String,
    pub(crate) made_with: MadeWith,
    pub(crate) tables: Tables,
}

impl Results {
    /// Reads what a run left in the folder of an experiment.
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
                tables.insert(stem.to_string_lossy().into_owned(), frame::read(&path)?);
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

    /// The experiment's part of the report; figures are written into its folder.
    fn section(
        &self,
        file: &ExperimentFile,
        algorithms: &Algorithms,
        folder: &Path,
    ) -> Result<Section, Error> {
        let experiment = self.made_with.experiment.kind()?;
        let mut blocks = experiment.present(&self.tables, algorithms, folder)?;
        if !self.made_with.failures.is_empty() {
            let failures = self.made_with.failures.join("; ");
            blocks.push(Block::Text(format!("What failed: {failures}.")));
        }
        Ok(Section {
            name: self.name.clone(),
            title: file.title.clone(),
            paper: file.paper.clone(),
            question: file.question.clone(),
            is_quick: self.made_with.quick,
            misleads: file.misleads.clone(),
            blocks,
            verdicts: self.verdicts(file),
            command: self.command(file),
            made_with: self.made_with(),
            files: self
                .tables
                .keys()
                .map(|name| format!("{name}.csv"))
                .collect(),
        })
    }

    /// Arguments that run it as it was run; `file` says what is run without any.
    fn command(&self, file: &ExperimentFile) -> String {
        let mut command = format!("run {}", self.name);
        if self.made_with.quick {
            command += " --quick";
        }
        let model = self.made_with.experiment.model();
        if let Some((model, scale)) = model.filter(|_| model != file.model()) {
            command += &format!(" --model {model} --scale {scale}");
        }
        command
    }

    fn made_with(&self) -> Vec<String> {
        let environment = &self.made_with.environment;
        let revision = match environment.revision.as_str() {
            "" => "unknown",
            revision => revision,
        };
        let core = match environment.core {
            Some(core) => format!("kept on core {core}"),
            None => "kept on no core".into(),
        };
        vec![
            format!(
                "{}, {} logical cores, {core}, {} MiB, {} (kernel {})",
                environment.processor,
                environment.logical_cores,
                environment.memory_mib,
                environment.system,
                environment.kernel
            ),
            format!(
                "{}, profile {}; rapier3d {}, parry3d {}; revision {revision}",
                environment.rustc, environment.profile, environment.rapier3d, environment.parry3d
            ),
            format!(
                "taking a time costs {} ns, which every time contains",
                environment.timer_overhead_ns
            ),
        ]
    }
}

/// Writes the report on experiments, given their names and files, from the tables in `records` into
/// `out`; gives the first table of each as Markdown.
pub(crate) fn write(
    experiments: &[(String, ExperimentFile)],
    algorithms: &Algorithms,
    records: &Path,
    out: &Path,
) -> Result<Vec<(String, String)>, Error> {
    let mut sections = Vec::new();
    for (name, file) in experiments {
        let results = Results::read(name, &records.join(name))?;
        let folder = out.join(name);
        std::fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
        if records != out {
            copy_pictures(&records.join(name), &folder)?;
        }
        sections.push(results.section(file, algorithms, &folder)?);
    }
    let others = others(records)?;
    let text = markdown::report(&sections, &others);
    write_atomically(&out.join(MARKDOWN), text.as_bytes())?;
    let html = html::report(&sections, &others, out)?;
    write_atomically(&out.join(HTML), html.as_bytes())?;
    let first_table = |section: &Section| {
        let table = section.blocks.iter().find_map(|block| match block {
            Block::Table(table) => Some(table.markdown()),
            _ => None,
        });
        (section.name.clone(), table.unwrap_or_default())
    };
    Ok(sections.iter().map(first_table).collect())
}

/// A report that something else made, in a folder beside those of the experiments.
struct Other {
    title: String,
    /// From the folder of the report.
    file: String,
}

/// Heading of the list of those.
const OTHERS: &str = "Measured by itself";

/// All of them, by the names of their folders.
fn others(records: &Path) -> Result<Vec<Other>, Error> {
    let mut all = Vec::new();
    for entry in std::fs::read_dir(records)? {
        let file = format!("{}/README.md", entry?.file_name().to_string_lossy());
        // What is no folder, and those of experiments, have none.
        let Ok(text) = std::fs::read_to_string(records.join(&file)) else {
            continue;
        };
        if let Some(title) = text.lines().find_map(|line| line.strip_prefix("# ")) {
            let title = title.to_owned();
            all.push(Other { title, file });
        }
    }
    all.sort_by(|a, b| a.file.cmp(&b.file));
    Ok(all)
}

/// Brings what a run drew, and a report only shows, to another folder.
fn copy_pictures(from: &Path, to: &Path) -> Result<(), Error> {
    for entry in std::fs::read_dir(from)? {
        let path = entry?.path();
        if let Some(name) = path.file_name()
            && path.extension().is_some_and(|e| e == "png")
        {
            std::fs::copy(&path, to.join(name))?;
        }
    }
    Ok(())
}

/// Replaces what stands between the marks of each table in a text that has marks of some of them.
pub(crate) fn spliced_all(text: &str, tables: &[(String, String)]) -> Result<String, String> {
    let mut all = None;
    for (name, table) in tables {
        if let Some(new) = spliced(all.as_deref().unwrap_or(text), name, table) {
            all = Some(new);
        }
    }
    let name = tables.first().map_or("NAME", |(name, _)| name);
    all.ok_or_else(|| {
        format!("there are no marks such as `<!-- {name} -->` and `<!-- /{name} -->`")
    })
}

/// Replaces what stands in a text between the marks `<!-- name -->` and `<!-- /name -->`; `None`
/// without them.
fn spliced(text: &str, name: &str, content: &str) -> Option<String> {
    let (open, close) = (format!("<!-- {name} -->"), format!("<!-- /{name} -->"));
    let start = text.find(&open)? + open.len();
    let end = start + text[start..].find(&close)?;
    Some(format!(
        "{}\n\n{}\n\n{}",
        &text[..start],
        content.trim(),
        &text[end..]
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_stands_between_the_marks_is_replaced() {
        let text = "a <!-- t -->old<!-- /t --> b";
        let new = spliced(text, "t", "new\n").unwrap();
        assert_eq!(new, "a <!-- t -->\n\nnew\n\n<!-- /t --> b");
        assert_eq!(spliced(&new, "t", "new").unwrap(), new);
        assert!(spliced(text, "u", "new").is_none());
        assert!(spliced("<!-- t -->", "t", "new").is_none());
    }
}
