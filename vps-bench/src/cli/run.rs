//! `run`: runs the jobs of experiments and makes their tables.

use vps_build::AssetCache;

use crate::cli::project::Project;
use crate::error::Error;
use crate::harness::context::Context;
use crate::harness::run::{self, Selection};

/// The result of running several experiments.
#[derive(Default)]
pub(super) struct Runs {
    /// Jobs left to other shards or filters.
    pub(super) missing: usize,
    /// Failures, a line each.
    pub(super) failures: Vec<String>,
}

/// Runs experiments; `replacement` is a model and its scale to be used in place of the configured
/// one.
pub(super) fn run(
    project: &Project,
    names: &[String],
    selection: Selection<'_>,
    replacement: Option<(&str, Option<f64>)>,
) -> Result<Runs, Error> {
    let assets = AssetCache::new(project.cache.join("assets"));
    let context = Context::new(project.algorithms()?, project.models()?, assets);
    let mut runs = Runs::default();
    for name in names {
        let mut file = project.file(name)?;
        if let Some((model, scale)) = replacement {
            file.set_model(model, scale)?;
        }
        for algorithm in file.kind()?.algorithms() {
            context
                .algorithms
                .get(algorithm)
                .map_err(|e| format!("{name}: {e}"))?;
        }
        let outcome = run::run(name, &file, selection, &context, &project.out.join(name))?;
        print!("{name}: {} jobs run, {} kept", outcome.run, outcome.kept);
        match outcome.missing {
            0 => println!(", tables in {}", project.out.join(name).display()),
            missing => println!(", {missing} left to others"),
        }
        runs.missing += outcome.missing;
        let failures = outcome.failures.iter();
        runs.failures
            .extend(failures.map(|f| format!("{name}: {f}")));
    }
    Ok(runs)
}
