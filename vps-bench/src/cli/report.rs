//! `report`: writes the report from tables, or checks that it is up to date.

use std::path::Path;

use vps_build::write_atomically;

use crate::cli::project::Project;
use crate::error::Error;
use crate::harness::scratch::Scratch;
use crate::report::{splice, write};

/// Writes the report and splices its tables into the file at `splice_path`. With `check` it writes
/// nothing and returns the files that are stale, a line each.
pub(super) fn report(
    project: &Project,
    names: &[String],
    splice_path: Option<&Path>,
    check: bool,
) -> Result<Vec<String>, Error> {
    let mut experiments = Vec::new();
    for name in project.named_or_run(names)? {
        let file = project.file(&name)?;
        experiments.push((name, file));
    }
    let algorithms = project.algorithms()?;
    let scratch = Scratch::new("vps-report")?;
    let out = if check { scratch.path() } else { &project.out };
    let tables = write::write(&experiments, &algorithms, &project.out, out)?;
    let mut stale = Vec::new();
    if check {
        // A report on only some of the experiments is not the one in the repository.
        if names.is_empty() {
            let kept = project.out.join(write::MARKDOWN);
            let made = std::fs::read(out.join(write::MARKDOWN))?;
            if std::fs::read(&kept).is_ok_and(|kept| kept != made) {
                let message = "not that of the tables: run `vps-bench report`";
                stale.push(format!("{}: {message}", kept.display()));
            }
        }
    } else {
        for file in [write::MARKDOWN, write::HTML] {
            println!("{}", out.join(file).display());
        }
    }
    let Some(path) = splice_path else {
        return Ok(stale);
    };
    let before = std::fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))?;
    let after = splice::splice_all(&before, &tables)
        .map_err(|message| format!("{}: {message}", path.display()))?;
    if after != before && check {
        let run = format!("run `vps-bench report --splice {}`", path.display());
        let message = format!(
            "{}: its tables are not those of the records: {run}",
            path.display()
        );
        stale.push(message);
    } else if after != before {
        write_atomically(path, after.as_bytes())?;
    }
    Ok(stale)
}
