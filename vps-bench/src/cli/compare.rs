//! `compare`: times in two folders of reports as ratios.

use std::path::Path;

use crate::error::Error;
use crate::report::comparison;

/// Prints the ratios as Markdown, or as CSV.
pub(super) fn compare(a: &Path, b: &Path, as_csv: bool) -> Result<Vec<String>, Error> {
    let comparisons = comparison::compare(a, b)?;
    if as_csv {
        print!("{}", comparison::csv(&comparisons)?);
    } else {
        print!("{}", comparison::text(&comparisons));
    }
    Ok(Vec::new())
}
