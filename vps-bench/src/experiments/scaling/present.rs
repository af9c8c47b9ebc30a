//! Presents the tables of times.

use super::{Case, QueryKind, Settings};
use crate::data::dataframe::rows;
use crate::data::number_format::{fixed, significant};
use crate::error::Error;
use crate::experiments::shared::power_law::{Labels, Series, color, figure};
use crate::report::document::{Block, Table};
use crate::report::page::Page;

pub(super) fn present(settings: &Settings, page: &Page<'_>) -> Result<Vec<Block>, Error> {
    let (times, slopes) = (page.table("times")?, page.table("slopes")?);
    let algorithms = page.algorithms;
    let label = |name: &str| -> String {
        let kind = QueryKind::ALL.into_iter().find(|kind| kind.name() == name);
        let listed = algorithms.get(name).map(|a| a.label.clone());
        kind.map_or_else(|| listed.unwrap_or(name.into()), |kind| kind.label().into())
    };
    let mut all = Table::new(
        "Slopes: the power of the size that time grows with",
        &["size", "query", "slope", "slope by contacts"],
    );
    for row in rows(slopes) {
        let case = Case::ALL.into_iter().find(|c| c.name() == row.text("case"));
        all.push([
            case.map_or_else(String::new, |c| c.label().into()),
            label(&row.text("algorithm")),
            fixed(row.number("slope"), 2),
            fixed(row.number("slope_by_contacts"), 2),
        ]);
    }
    let mut blocks = vec![Block::Table(all)];
    for case in Case::ALL {
        let names = settings.names(case);
        let of_case = || rows(times).filter(|row| row.text("case") == case.name());
        let mut series = Vec::new();
        for (i, name) in names.iter().enumerate() {
            let group = of_case().filter(|row| row.text("algorithm") == *name);
            let points =
                group.filter_map(|row| Some((row.number("size")?, row.number("time_us_median")?)));
            series.push(Series {
                label: label(name),
                color: algorithms.get(name).map_or(color(i), |a| a.rgb()),
                points: points.collect(),
            });
        }
        let (title, y) = if case == Case::Bodies {
            (
                "Time of a step a body",
                "median time of a step / bodies (µs)",
            )
        } else {
            ("Time of a query", "median time (µs)")
        };
        let title = format!("{title} by {}", case.label());
        let labels = Labels {
            stem: case.name(),
            title: &title,
            x: case.label(),
            y,
        };
        blocks.push(figure(&labels, series, page)?);
        let head = [
            case.label(),
            "query",
            "median µs",
            "mean",
            "p95",
            "contacts",
        ];
        let mut table = Table::new(title.clone(), &head);
        for row in of_case() {
            // Depths are 32-bit numbers and have no more digits.
            let size = row.number("size").map(|size| size as f32);
            table.push([
                size.map_or_else(String::new, |size| size.to_string()),
                label(&row.text("algorithm")),
                significant(row.number("time_us_median")),
                significant(row.number("time_us_mean")),
                significant(row.number("time_us_p95")),
                fixed(row.number("contacts_mean"), 1),
            ]);
        }
        blocks.push(Block::Table(table));
    }
    Ok(blocks)
}
