//! The command line: its arguments, the folders of a project, and one file a verb.

pub(crate) mod arguments;
mod check;
mod compare;
mod fetch;
mod list;
mod project;
mod report;
mod reproduce;
mod run;

use self::arguments::{Cli, Command};
use self::project::Project;
use crate::error::Error;

/// Executes a command and returns the failures that did not end it, a line each.
pub(crate) fn execute(cli: &Cli) -> Result<Vec<String>, Error> {
    let project = Project {
        experiments: cli.experiments.clone(),
        cache: cli.cache.clone(),
        out: cli.out.clone(),
    };
    match &cli.command {
        Command::List => list::list(&project),
        Command::Fetch { models } => fetch::fetch(&project, models),
        Command::Run {
            names,
            selection,
            model,
            scale,
        } => {
            let replacement = model.as_deref().map(|model| (model, *scale));
            let runs = run::run(&project, names, selection.selection(), replacement)?;
            Ok(runs.failures)
        }
        Command::Report {
            names,
            splice,
            check,
        } => report::report(&project, names, splice.as_deref(), *check),
        Command::Check { names } => check::check(&project, names),
        Command::Compare { a, b, csv, within } => compare::compare(a, b, *csv, *within),
        Command::ExecuteQueries { times, target } => {
            target.execute(*times, None)?;
            Ok(Vec::new())
        }
        Command::Reproduce { selection, splice } => {
            reproduce::reproduce(&project, selection.selection(), splice.as_deref())
        }
    }
}
