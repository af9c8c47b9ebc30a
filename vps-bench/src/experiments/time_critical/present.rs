//! Presents the tables of time-critical queries.

use plotters::style::RGBColor;
use polars::prelude::DataFrame;

use super::{Limit, Settings};
use crate::data::dataframe::{Row, rows_of};
use crate::data::number_format::{fixed, significant};
use crate::error::Error;
use crate::figures::axis::Axis;
use crate::figures::figure::{Curve, Figure, decades};
use crate::report::document::{Block, Table};
use crate::report::page::Page;

pub(super) fn present(settings: &Settings, page: &Page<'_>) -> Result<Vec<Block>, Error> {
    let presentation = Presentation {
        settings,
        summary: page.table("summary")?,
        page,
    };
    let mut blocks = Vec::new();
    for name in &settings.algorithms {
        blocks.push(presentation.errors(name)?);
        blocks.push(presentation.curve(
            name,
            "penetration_error_mm",
            "Deepest contact: how much too little",
            "penetration error (mm)",
            1.0,
        )?);
        blocks.push(presentation.curve(
            name,
            "force_error",
            "Penalty force: how far off",
            "force error (%)",
            100.0,
        )?);
        blocks.push(presentation.deadlines(name)?);
    }
    Ok(blocks)
}

struct Presentation<'p> {
    settings: &'p Settings,
    summary: &'p DataFrame,
    page: &'p Page<'p>,
}

/// Quantiles, their columns and colours.
const QUANTILES: [(&str, &str, RGBColor); 3] = [
    ("median", "median", RGBColor(0, 114, 178)),
    ("p99", "99th percentile", RGBColor(230, 159, 0)),
    ("max", "largest", RGBColor(213, 94, 0)),
];

impl Presentation<'_> {
    fn of(&self, limit: Limit, algorithm: &str) -> Option<Row<'_>> {
        let case = limit.case();
        rows_of(self.summary, &case, algorithm).next()
    }

    /// Median, 99th percentile and largest.
    fn quantiles(row: &Row<'_>, what: &str, factor: f64) -> String {
        let number = |q: &str| {
            let value = row.number(&format!("{what}_{q}"));
            significant(value.map(|v| factor * v))
        };
        QUANTILES.map(|(q, ..)| number(q)).join(" / ")
    }

    fn errors(&self, algorithm: &str) -> Result<Block, Error> {
        let mut table = Table::new(
            format!(
                "{}: error by budget, median / 99th percentile / largest",
                self.page.label(algorithm)?
            ),
            &[
                "points tested at most",
                "complete",
                "penetration underestimated, mm",
                "bound, mm too much",
                "force, % off",
                "time, µs",
            ],
        );
        for limit in self.settings.budgets().chain([Limit::None]) {
            let Some(row) = self.of(limit, algorithm) else {
                continue;
            };
            table.push([
                match limit {
                    Limit::Points(points) => points.to_string(),
                    _ => "no limit".into(),
                },
                format!("{} %", fixed(row.number("complete_percent"), 1)),
                Self::quantiles(&row, "penetration_error_mm", 1.0),
                Self::quantiles(&row, "bound_error_mm", 1.0),
                Self::quantiles(&row, "force_error", 100.0),
                Self::quantiles(&row, "query_us", 1.0),
            ]);
        }
        Ok(Block::Table(table))
    }

    fn deadlines(&self, algorithm: &str) -> Result<Block, Error> {
        let mut table = Table::new(
            format!(
                "{}: deadlines, the query stopped {} µs before",
                self.page.label(algorithm)?,
                self.settings.reserve_us
            ),
            &[
                "deadline, µs",
                "complete",
                "overruns",
                "longest, µs late",
                "late by itself",
                "idle loop: overruns",
                "longest, µs late",
                "penetration underestimated, mm",
                "force, % off",
            ],
        );
        let of_all = |row: &Row<'_>, some: &str, all: &str| {
            let number = |column: &str| row.number(column);
            let percent = number(some)
                .zip(number(all))
                .map(|(n, all)| 100.0 * n / all);
            format!(
                "{} of {} ({} %)",
                fixed(number(some), 0),
                fixed(number(all), 0),
                fixed(percent, 3)
            )
        };
        for limit in self.settings.deadlines() {
            let Some(row) = self.of(limit, algorithm) else {
                continue;
            };
            table.push([
                limit.case().trim_end_matches("us").to_owned(),
                format!("{} %", fixed(row.number("complete_percent"), 1)),
                of_all(&row, "overruns", "poses"),
                fixed(row.number("overrun_us_max"), 0),
                fixed(row.number("late_by_itself"), 0),
                of_all(&row, "idle_overruns", "idle_loops"),
                fixed(row.number("idle_overrun_us_max"), 0),
                Self::quantiles(&row, "penetration_error_mm", 1.0),
                Self::quantiles(&row, "force_error", 100.0),
            ]);
        }
        Ok(Block::Table(table))
    }

    /// Errors by budget.
    fn curve(
        &self,
        algorithm: &str,
        what: &str,
        title: &str,
        label: &str,
        factor: f64,
    ) -> Result<Block, Error> {
        let curves = QUANTILES.map(|(q, name, color)| {
            let points = self.settings.budget_points.iter().filter_map(|&budget| {
                let row = self.of(Limit::Points(budget), algorithm)?;
                let value = factor * row.number(&format!("{what}_{q}"))?;
                // An error of zero cannot be drawn on a logarithmic axis.
                (value > 0.0 && value.is_finite()).then_some((budget as f64, value))
            });
            Curve {
                label: name.into(),
                color,
                polylines: vec![points.collect()],
                has_markers: true,
            }
        });
        let curves: Vec<_> = curves.into();
        let budgets = self.settings.budget_points.iter().map(|&b| b as f64);
        let (low, high) = budgets.fold((f64::INFINITY, 10.0), |(low, high): (f64, f64), b| {
            (low.min(b), high.max(b))
        });
        let decade = |x: f64| 10_f64.powf(x);
        let low = low.min(high).log10().floor();
        let x = decade(low)..decade(high.log10().ceil().max(low + 1.0));
        let y = decades(&curves, &[], 1e-4);
        let figure = Figure {
            title: format!("{title}, {}", self.page.label(algorithm)?),
            x: Axis::logarithmic("points tested at most", x),
            // Space for the legend above the curves.
            y: Axis::logarithmic(label, y.start..y.end * 10.0),
            curves,
            reference_lines: Vec::new(),
            reference_label: String::new(),
        };
        self.page.figure(&format!("{what}_{algorithm}"), &figure)
    }
}
