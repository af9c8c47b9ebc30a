//! `reproduce`: fetches the models, runs, reports and checks the experiments.

use std::path::Path;

use crate::cli::project::Project;
use crate::cli::{check, fetch, report, run};
use crate::error::Error;
use crate::harness::run::Selection;

/// Does all this in turn, for the experiments that are to be reproduced, and returns all failures.
/// While jobs of other shards are missing there is no report.
pub(super) fn reproduce(
    project: &Project,
    selection: Selection<'_>,
    splice_path: Option<&Path>,
) -> Result<Vec<String>, Error> {
    fetch::fetch(project, &[])?;
    let mut names = Vec::new();
    for name in project.names()? {
        if project.file(&name)?.reproduced {
            names.push(name);
        }
    }
    let runs = run::run(project, &names, selection, None)?;
    let mut failures = runs.failures;
    if runs.missing > 0 {
        return Ok(failures);
    }
    failures.extend(report::report(project, &[], splice_path, false)?);
    failures.extend(check::check(project, &[])?);
    Ok(failures)
}
