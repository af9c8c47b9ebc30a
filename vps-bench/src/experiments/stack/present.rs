//! Presents the tables of stacks.

use super::Settings;
use crate::data::dataframe::Row;
use crate::data::number_format::fixed;
use crate::error::Error;
use crate::report::document::Block;
use crate::report::page::Page;

pub(super) fn present(settings: &Settings, page: &Page<'_>) -> Result<Vec<Block>, Error> {
    let cases = settings.balls.iter();
    let cases = cases.map(|&n| (format!("{n} balls"), Settings::case(n)));
    let cases: Vec<_> = cases.collect();
    let algorithms = &settings.algorithms;
    let stood = |row: &Row<'_>| {
        let time = |column: &str| match row.number(column) {
            Some(time) if time >= settings.duration_s => format!("> {}", settings.duration_s),
            time => fixed(time, 2),
        };
        format!(
            "{} ({} to {})",
            time("stood_s_median"),
            time("stood_s_p25"),
            time("stood_s_p75")
        )
    };
    let fell = |row: &Row<'_>| {
        let count = |column: &str| fixed(row.number(column), 0);
        format!("{} of {}", count("fell"), count("stacks"))
    };
    let depth = |row: &Row<'_>| fixed(row.number("true_penetration_mm_max"), 1);
    Ok(vec![
        page.by_case(
            "Time standing in s: median of all stacks (and quartiles)",
            algorithms,
            &cases,
            stood,
        )?,
        page.by_case("Stacks that fell", algorithms, &cases, fell)?,
        page.by_case(
            "True penetration at its deepest while standing, mm",
            algorithms,
            &cases,
            depth,
        )?,
    ])
}
