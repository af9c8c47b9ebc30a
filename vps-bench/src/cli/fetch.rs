//! `fetch`: downloads models.

use std::time::Duration;

use indicatif::ProgressBar;

use crate::cli::project::Project;
use crate::error::Error;

/// Fetches the named models, or all of them, and prints where they are.
pub(super) fn fetch(project: &Project, names: &[String]) -> Result<Vec<String>, Error> {
    let models = project.models()?;
    let all: Vec<_> = models.names().map(String::from).collect();
    for name in if names.is_empty() { &all } else { names } {
        let progress = ProgressBar::new_spinner().with_message(format!("fetching {name}"));
        progress.enable_steady_tick(Duration::from_millis(200));
        let file = models.file(name)?;
        progress.finish_and_clear();
        println!("{name}: {}", file.display());
    }
    Ok(Vec::new())
}
