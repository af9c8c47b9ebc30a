//! `check`: judges the claims.

use crate::cli::project::Project;
use crate::data::number_format::significant;
use crate::error::Error;
use crate::report::results::Results;

/// Prints all verdicts and returns those that differ from the expectation. A quick run has too few
/// starts to fail a claim.
pub(super) fn check(project: &Project, names: &[String]) -> Result<Vec<String>, Error> {
    let mut failures = Vec::new();
    for name in project.named_or_run(names)? {
        let file = project.file(&name)?;
        let results = Results::read(&name, &project.out.join(&name))?;
        let is_quick = results.made_with.quick;
        for verdict in results.verdicts(&file) {
            let claim = &verdict.claim;
            let measured = significant(verdict.measured);
            let outcome = verdict.outcome.text();
            let quick = if is_quick { ", a quick run" } else { "" };
            println!(
                "{name}/{}: {outcome}: {measured} ({}){quick}",
                claim.name,
                claim.range()
            );
            if !is_quick && !verdict.is_as_expected() {
                failures.push(format!(
                    "{name}/{}: {outcome}, but {} was expected: {}",
                    claim.name,
                    claim.expect.text(),
                    claim.says
                ));
            }
        }
    }
    Ok(failures)
}
