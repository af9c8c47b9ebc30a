//! Presents the tables of stacks.

use polars::prelude::DataFrame;

use super::Settings;
use crate::config::algorithms::Algorithms;
use crate::data::dataframe::{Row, rows_of};
use crate::data::number_format::fixed;
use crate::data::tables::{Tables, table};
use crate::error::Error;
use crate::report::document::{Block, Table};

pub(super) fn present(
    settings: &Settings,
    tables: &Tables,
    algorithms: &Algorithms,
) -> Result<Vec<Block>, Error> {
    let summary = table(tables, "summary")?;
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
        by_balls(
            settings,
            summary,
            algorithms,
            "Time standing in s: median of all stacks (and quartiles)",
            stood,
        )?,
        by_balls(settings, summary, algorithms, "Stacks that fell", fell)?,
        by_balls(
            settings,
            summary,
            algorithms,
            "True penetration at its deepest while standing, mm",
            depth,
        )?,
    ])
}

/// A row for each algorithm, a column for each number of balls.
fn by_balls(
    settings: &Settings,
    summary: &DataFrame,
    algorithms: &Algorithms,
    caption: &str,
    cell: impl Fn(&Row<'_>) -> String,
) -> Result<Block, Error> {
    let mut head = vec!["algorithm".to_owned()];
    head.extend(settings.balls.iter().map(|n| format!("{n} balls")));
    let head: Vec<_> = head.iter().map(String::as_str).collect();
    let mut table = Table::new(caption, &head);
    for name in &settings.algorithms {
        let cells = settings.balls.iter().map(|&balls| {
            let case = Settings::case(balls);
            let row = rows_of(summary, &case, name).next();
            row.map_or_else(|| "–".into(), |row| cell(&row))
        });
        let cells: Vec<_> = cells.collect();
        table.push(
            [algorithms.get(name)?.label.clone()]
                .into_iter()
                .chain(cells),
        );
    }
    Ok(Block::Table(table))
}
