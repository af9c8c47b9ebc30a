//! What the subcommands do.

use std::path::{Path, PathBuf};
use std::time::Duration;

use indicatif::ProgressBar;
use vps_build::{AssetCache, write_atomically};

use crate::algorithms::Algorithms;
use crate::config::ExperimentFile;
use crate::experiments::Error;
use crate::lab::Lab;
use crate::models::Models;
use crate::report::{self, Results};
use crate::run::{self, Choice};
use crate::scratch::Scratch;

/// The folders of a project.
pub(crate) struct Project {
    pub(crate) experiments: PathBuf,
    pub(crate) cache: PathBuf,
    pub(crate) out: PathBuf,
}

/// What became of several experiments.
#[derive(Default)]
pub(crate) struct Runs {
    /// Jobs that are left to other shards or filters.
    pub(crate) missing: usize,
    /// What failed, a line each.
    pub(crate) failures: Vec<String>,
}

impl Project {
    /// Names of all experiments, in the order of the paper as their files say it.
    pub(crate) fn names(&self) -> Result<Vec<String>, Error> {
        let folder = &self.experiments;
        let entries =
            std::fs::read_dir(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
        let mut named = Vec::new();
        for entry in entries {
            let path = entry?.path();
            let stem = path
                .file_stem()
                .unwrap_or_default()
                .to_string_lossy()
                .into_owned();
            let is_list = ["models", "algorithms"].contains(&stem.as_str());
            if path.extension().is_some_and(|e| e == "toml") && !is_list {
                named.push((self.file(&stem)?.order, stem));
            }
        }
        named.sort();
        Ok(named.into_iter().map(|(_, name)| name).collect())
    }

    fn file(&self, name: &str) -> Result<ExperimentFile, Error> {
        Ok(ExperimentFile::read(
            &self.experiments.join(format!("{name}.toml")),
        )?)
    }

    fn algorithms(&self) -> Result<Algorithms, Error> {
        Ok(Algorithms::read(&self.experiments.join("algorithms.toml"))?)
    }

    fn models(&self) -> Result<Models, Error> {
        let list = self.experiments.join("models.toml");
        Ok(Models::read(&list, &self.cache.join("models"))?)
    }

    /// Those named, or all that were run.
    fn named_or_run(&self, names: &[String]) -> Result<Vec<String>, Error> {
        if !names.is_empty() {
            return Ok(names.to_vec());
        }
        let mut names = self.names()?;
        names.retain(|name| self.out.join(name).join("made_with.json").exists());
        if names.is_empty() {
            return Err(format!("{}: no experiment has been run", self.out.display()).into());
        }
        Ok(names)
    }

    pub(crate) fn list(&self) -> Result<Vec<String>, Error> {
        for name in self.names()? {
            let file = self.file(&name)?;
            let jobs = file.kind()?.jobs(false).len();
            println!("{name:20} {jobs:5} jobs  {} ({})", file.title, file.paper);
        }
        Ok(Vec::new())
    }

    pub(crate) fn fetch(&self, names: &[String]) -> Result<Vec<String>, Error> {
        let models = self.models()?;
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

    /// Runs experiments, on another model if one is given with its scale.
    pub(crate) fn run(
        &self,
        names: &[String],
        choice: Choice<'_>,
        other: Option<(&str, Option<f64>)>,
    ) -> Result<Runs, Error> {
        let assets = AssetCache::new(self.cache.join("assets"));
        let lab = Lab::new(self.algorithms()?, self.models()?, assets);
        let mut runs = Runs::default();
        for name in names {
            let mut file = self.file(name)?;
            if let Some((model, scale)) = other {
                file.set_model(model, scale)?;
            }
            for algorithm in file.kind()?.algorithms() {
                lab.algorithms
                    .get(algorithm)
                    .map_err(|e| format!("{name}: {e}"))?;
            }
            let outcome = run::run(name, &file, choice, &lab, &self.out.join(name))?;
            print!("{name}: {} jobs run, {} kept", outcome.run, outcome.kept);
            match outcome.missing {
                0 => println!(", tables in {}", self.out.join(name).display()),
                missing => println!(", {missing} left to others"),
            }
            runs.missing += outcome.missing;
            let failures = outcome.failures.iter();
            runs.failures
                .extend(failures.map(|f| format!("{name}: {f}")));
        }
        Ok(runs)
    }

    /// Writes the report and puts tables into `splice`. With `check` it writes nothing and gives what
    /// is not as it should be.
    pub(crate) fn report(
        &self,
        names: &[String],
        splice: Option<&Path>,
        check: bool,
    ) -> Result<Vec<String>, Error> {
        let mut experiments = Vec::new();
        for name in self.named_or_run(names)? {
            let file = self.file(&name)?;
            experiments.push((name, file));
        }
        let algorithms = self.algorithms()?;
        let scratch = Scratch::new("vps-report")?;
        let out = if check { scratch.path() } else { &self.out };
        let tables = report::write(&experiments, &algorithms, &self.out, out)?;
        let mut stale = Vec::new();
        if check {
            // A report on some of the experiments is not the one that is kept.
            if names.is_empty() {
                let kept = self.out.join(report::MARKDOWN);
                let made = std::fs::read(out.join(report::MARKDOWN))?;
                if std::fs::read(&kept).is_ok_and(|kept| kept != made) {
                    let what = "not that of the tables: run `vps-bench report`";
                    stale.push(format!("{}: {what}", kept.display()));
                }
            }
        } else {
            for file in [report::MARKDOWN, report::HTML] {
                println!("{}", out.join(file).display());
            }
        }
        let Some(path) = splice else {
            return Ok(stale);
        };
        let before =
            std::fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))?;
        let after = report::spliced_all(&before, &tables)
            .map_err(|what| format!("{}: {what}", path.display()))?;
        if after != before && check {
            let run = format!("run `vps-bench report --splice {}`", path.display());
            let what = format!(
                "{}: its tables are not those of the records: {run}",
                path.display()
            );
            stale.push(what);
        } else if after != before {
            write_atomically(path, after.as_bytes())?;
        }
        Ok(stale)
    }

    /// Prints all verdicts; gives those that turned out otherwise than expected. A quick run has too
    /// few starts to fail a claim.
    pub(crate) fn check(&self, names: &[String]) -> Result<Vec<String>, Error> {
        let mut failures = Vec::new();
        for name in self.named_or_run(names)? {
            let file = self.file(&name)?;
            let results = Results::read(&name, &self.out.join(&name))?;
            let is_quick = results.made_with.quick;
            for verdict in results.verdicts(&file) {
                let claim = &verdict.claim;
                let measured = crate::page::short(verdict.measured);
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
}
