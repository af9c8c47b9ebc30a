//! What the command does: two meshes and poses to measurements, those to a summary.

mod algorithms;
mod args;
mod guard;
mod measure;
mod poses;
mod setting;
mod summary;
mod table;

use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

pub(crate) use args::Args;

use algorithms::{Built, prepare};
use measure::measure;
use setting::Setting;
use summary::Summary;

/// One line for people.
type Error = Box<dyn std::error::Error>;

pub(crate) fn run(args: &Args) -> Result<(), Error> {
    args.check()?;
    let progress = progress()?;
    progress.set_message("reading the meshes");
    let setting = Setting::of(args, &progress)?;
    let (mut candidates, built) = (Vec::new(), Built::default());
    for name in args.algorithms() {
        progress.set_message(format!("preparing {name}"));
        candidates.push(prepare(name, args, &setting, &built));
    }
    let rows = measure(&setting, &candidates, args.repeat, &progress);
    progress.finish_and_clear();
    if let Some(path) = &args.csv {
        let mut writer = csv::Writer::from_writer(Vec::new());
        for row in &rows {
            writer.serialize(row)?;
        }
        let bytes = writer.into_inner().map_err(|e| e.into_error())?;
        vps_build::write_atomically(path, &bytes)?;
    }
    let summary = Summary::of(args, &setting, &candidates, &rows);
    if args.json {
        println!("{}", serde_json::to_string_pretty(&summary)?);
    } else {
        print!("{}", table::text(&summary));
    }
    Ok(())
}

/// Draws nothing when standard error is not a terminal.
fn progress() -> Result<ProgressBar, Error> {
    let progress = ProgressBar::no_length();
    progress.set_style(ProgressStyle::with_template("{spinner} {msg} ({elapsed})")?);
    progress.enable_steady_tick(Duration::from_millis(100));
    Ok(progress)
}
