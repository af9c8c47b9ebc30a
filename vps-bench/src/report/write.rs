//! Writes the report from the small tables of all experiments.

use std::path::Path;

use vps_build::write_atomically;

use crate::config::algorithms::Algorithms;
use crate::error::Error;
use crate::experiments::registry::ExperimentFile;
use crate::report::document::{Block, Section};
use crate::report::page::Page;
use crate::report::results::Results;
use crate::report::{html, markdown};

/// Files of the report.
pub(crate) const MARKDOWN: &str = "report.md";
pub(crate) const HTML: &str = "report.html";

/// Writes the report on experiments, given by names and files, from the tables in `records` into
/// `out`; returns the first table of each as Markdown.
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
        sections.push(section(&results, file, algorithms, &folder)?);
    }
    let text = markdown::report(&sections);
    write_atomically(&out.join(MARKDOWN), text.as_bytes())?;
    let html = html::report(&sections, out)?;
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

/// Copies the pictures that runs drew to another folder.
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

/// The section of an experiment; figures are written into its folder.
fn section(
    results: &Results,
    file: &ExperimentFile,
    algorithms: &Algorithms,
    folder: &Path,
) -> Result<Section, Error> {
    let experiment = results.made_with.experiment.kind()?;
    let page = Page {
        tables: &results.tables,
        algorithms,
        folder,
    };
    let mut blocks = experiment.present(&page)?;
    if !results.made_with.failures.is_empty() {
        let failures = results.made_with.failures.join("; ");
        blocks.push(Block::Text(format!("Failed: {failures}.")));
    }
    Ok(Section {
        name: results.name.clone(),
        title: file.title.clone(),
        paper: file.paper.clone(),
        question: file.question.clone(),
        is_quick: results.made_with.quick,
        misleads: file.misleads.clone(),
        blocks,
        verdicts: results.verdicts(file),
        command: command(results, file),
        made_with: made_with(results),
        files: results
            .tables
            .keys()
            .map(|name| format!("{name}.csv"))
            .collect(),
    })
}

/// Arguments that repeat the run; `file` has the defaults.
fn command(results: &Results, file: &ExperimentFile) -> String {
    let mut command = format!("run {}", results.name);
    if results.made_with.quick {
        command += " --quick";
    }
    let model = results.made_with.experiment.model();
    if let Some((model, scale)) = model.filter(|_| model != file.model()) {
        command += &format!(" --model {model} --scale {scale}");
    }
    command
}

fn made_with(results: &Results) -> Vec<String> {
    let environment = &results.made_with.environment;
    let revision = match environment.revision.as_str() {
        "" => "unknown",
        revision => revision,
    };
    let core = match environment.core {
        Some(core) => format!("kept on core {core}"),
        None => "kept on no core".into(),
    };
    let mut lines = vec![
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
    ];
    if let (false, Some(load)) = (environment.scheduling.is_empty(), environment.load_average) {
        lines.push(format!(
            "scheduling: {}; load average of the minute before: {load:.1}",
            environment.scheduling
        ));
    }
    lines
}
