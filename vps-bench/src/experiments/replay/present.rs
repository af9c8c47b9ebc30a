//! Presents the tables of replayed poses.

use super::Settings;
use crate::config::algorithms::Algorithm;
use crate::data::dataframe::{Row, rows};
use crate::data::number_format::{fixed, significant};
use crate::error::Error;
use crate::figures::axis::Axis;
use crate::figures::figure::{Curve, Figure, decades};
use crate::report::document::{Block, Table};
use crate::report::page::Page;

/// Smaller errors are drawn at this one, in mm: they are those of 32-bit numbers.
const MIN_ERROR_MM: f64 = 1e-5;

pub(super) fn present(settings: &Settings, page: &Page<'_>) -> Result<Vec<Block>, Error> {
    let summary = page.table("summary")?;
    let mut of_each = Vec::new();
    for name in &settings.algorithms {
        let algorithm = page.algorithms.get(name)?;
        if let Some(row) = rows(summary).find(|row| row.text("algorithm") == *name) {
            of_each.push((algorithm, row));
        }
    }
    let mut times = Table::new(
        "Collision query at the same poses, µs",
        &[
            "algorithm",
            "min",
            "median",
            "mean",
            "p95",
            "p99",
            "max",
            "contacts",
        ],
    );
    let mut errors = Table::new(
        format!(
            "Reported minus true penetration, mm; touches with a tolerance of {} mm",
            significant(settings.tolerance_m * 1e3)
        ),
        &[
            "algorithm",
            "mean",
            "from",
            "to",
            "median of size",
            "p95 of size",
            "max of size",
            "missed touches",
            "false touches",
            "near without a contact",
        ],
    );
    let mut curves = Vec::new();
    for (algorithm, row) in &of_each {
        let label = || algorithm.label.clone();
        let numbers = |columns: &[&str]| {
            let cells = columns.iter().map(|column| significant(row.number(column)));
            cells.collect::<Vec<_>>()
        };
        let all_times = [
            "query_us_min",
            "query_us_median",
            "query_us_mean",
            "query_us_p95",
            "query_us_p99",
            "query_us_max",
        ];
        let contacts = fixed(row.number("contacts_mean"), 1);
        times.push([vec![label()], numbers(&all_times), vec![contacts]].concat());
        let all_errors = [
            "error_mm_mean",
            "error_mm_least",
            "error_mm_most",
            "error_mm_abs_median",
            "error_mm_abs_p95",
            "error_mm_abs_max",
        ];
        let of = |column: &str, all: &str| {
            let [part, all] = [column, all].map(|c| fixed(row.number(c), 0));
            format!("{part} of {all}")
        };
        let counts = vec![
            of("missed", "overlaps"),
            of("false_touches", "poses"),
            of("silent", "poses"),
        ];
        errors.push([vec![label()], numbers(&all_errors), counts].concat());
        curves.extend(error_and_time(algorithm, row));
    }
    let ends = |at: fn(&(f64, f64)) -> f64| {
        let values: Vec<_> = curves
            .iter()
            .flat_map(|c| &c.polylines[0])
            .map(at)
            .collect();
        decades(&[], &values, MIN_ERROR_MM)
    };
    let (x, y) = (ends(|p| p.0), ends(|p| p.1));
    let figure = Figure {
        title: "Mean time of a query against its error, one dot an algorithm".into(),
        x: Axis::logarithmic("median size of the error of penetration (mm)", x),
        // Space for the legend above the points.
        y: Axis::logarithmic("mean time (µs)", y.start..y.end * 1000.0),
        curves,
        reference_lines: Vec::new(),
        reference_label: String::new(),
    };
    Ok(vec![
        Block::Table(times),
        Block::Table(errors),
        page.figure("time_and_error", &figure)?,
    ])
}

/// The point of an algorithm: error and time.
fn error_and_time(algorithm: &Algorithm, row: &Row<'_>) -> Option<Curve> {
    let error = row.number("error_mm_abs_median")?.max(MIN_ERROR_MM);
    Some(Curve {
        label: algorithm.label.clone(),
        color: algorithm.rgb(),
        polylines: vec![vec![(error, row.number("query_us_mean")?)]],
        has_markers: true,
    })
}
