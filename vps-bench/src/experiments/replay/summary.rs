//! Summarizes the answers at replayed poses.

use polars::prelude::DataFrame;
use serde::Serialize;

use super::Settings;
use super::answer::Answer;
use crate::data::dataframe::{self, Row, rows};
use crate::data::stats::Sample;
use crate::data::tables::Tables;
use crate::error::Error;

/// One algorithm over all poses of all seeds.
#[derive(Serialize)]
struct SummaryRow<'s> {
    algorithm: &'s str,
    poses: f64,
    query_us_min: Option<f64>,
    query_us_median: Option<f64>,
    query_us_mean: Option<f64>,
    query_us_p95: Option<f64>,
    query_us_p99: Option<f64>,
    query_us_max: Option<f64>,
    contacts_mean: Option<f64>,
    /// Reported minus true penetration.
    error_mm_mean: Option<f64>,
    error_mm_least: Option<f64>,
    error_mm_most: Option<f64>,
    /// Absolute errors.
    error_mm_abs_median: Option<f64>,
    error_mm_abs_p95: Option<f64>,
    error_mm_abs_max: Option<f64>,
    /// Poses that overlap by more than the tolerance, and those of them without a touch found.
    overlaps: usize,
    missed: usize,
    false_touches: usize,
    silent: usize,
}

/// `summary`: a row for each algorithm.
pub(super) fn summarize(settings: &Settings, records: &DataFrame) -> Result<Tables, Error> {
    let mut summary = Vec::new();
    for algorithm in &settings.algorithms {
        let group = rows(records).filter(|row| row.text("algorithm") == *algorithm);
        let group: Vec<_> = group.collect();
        if !group.is_empty() {
            summary.push(summarize_group(settings, algorithm, &group));
        }
    }
    Ok(Tables::from([("summary".into(), dataframe::of(summary)?)]))
}

fn summarize_group<'s>(
    settings: &Settings,
    algorithm: &'s str,
    rows: &[Row<'_>],
) -> SummaryRow<'s> {
    let column = |name: &str| Sample::of(rows.iter().filter_map(|row| row.number(name)));
    let answers: Vec<_> = rows
        .iter()
        .filter_map(|row| {
            Some(Answer {
                reported: row.number("penetration_m"),
                truth: row.number("true_penetration_m")?,
            })
        })
        .collect();
    let errors = || answers.iter().filter_map(|a| Some(a.error()? * 1e3));
    let (signed, size) = (Sample::of(errors()), Sample::of(errors().map(f64::abs)));
    let count = |is: &dyn Fn(&Answer) -> bool| answers.iter().filter(|a| is(a)).count();
    let (tolerance, times) = (settings.tolerance_m, column("query_us"));
    let prediction = settings.fall.prediction_m.into();
    SummaryRow {
        algorithm,
        poses: times.count(),
        query_us_min: times.min(),
        query_us_median: times.median(),
        query_us_mean: times.mean(),
        query_us_p95: times.quantile(0.95),
        query_us_p99: times.quantile(0.99),
        query_us_max: times.max(),
        contacts_mean: column("contacts").mean(),
        error_mm_mean: signed.mean(),
        error_mm_least: signed.min(),
        error_mm_most: signed.max(),
        error_mm_abs_median: size.median(),
        error_mm_abs_p95: size.quantile(0.95),
        error_mm_abs_max: size.max(),
        overlaps: count(&|a| a.truth > tolerance),
        missed: count(&|a| a.is_missed(tolerance)),
        false_touches: count(&|a| a.is_false_touch(tolerance)),
        silent: count(&|a| a.is_silent(prediction, tolerance)),
    }
}
