//! `list`: the experiments, and how many jobs each has.

use crate::cli::project::Project;
use crate::error::Error;

/// Prints a line for each experiment.
pub(super) fn list(project: &Project) -> Result<Vec<String>, Error> {
    for name in project.names()? {
        let file = project.file(&name)?;
        let jobs = file.kind()?.jobs(false).len();
        println!("{name:20} {jobs:5} jobs  {} ({})", file.title, file.paper);
    }
    Ok(Vec::new())
}
