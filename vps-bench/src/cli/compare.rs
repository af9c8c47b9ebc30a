//! `compare`: times and instructions in two folders of reports as ratios.

use std::path::Path;

use crate::error::Error;
use crate::report::comparison;

/// Prints the ratios as Markdown, or as CSV, and returns those that are off by more than
/// `within_percent`, a line each.
pub(super) fn compare(
    a: &Path,
    b: &Path,
    as_csv: bool,
    within_percent: Option<f64>,
) -> Result<Vec<String>, Error> {
    let comparisons = comparison::compare(a, b)?;
    if as_csv {
        print!("{}", comparison::csv(&comparisons)?);
    } else {
        print!("{}", comparison::text(&comparisons));
    }
    Ok(within_percent.map_or_else(Vec::new, |percent| {
        comparison::beyond(&comparisons, percent)
    }))
}
