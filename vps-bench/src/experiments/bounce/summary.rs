//! Summarizes bounces.

use polars::prelude::*;

use super::{Case, Settings};
use crate::data::tables::Tables;
use crate::error::Error;

/// `summary`: a row for each case and algorithm, over all start orientations. `course`: heights
/// over time of the first orientation in the cases that are drawn.
pub(super) fn summarize(settings: &Settings, rows: &DataFrame) -> Result<Tables, Error> {
    let mut parts = Vec::new();
    for case in settings.cases() {
        for algorithm in &settings.algorithms {
            let group = rows.clone().lazy().filter(
                col("case")
                    .eq(lit(case.name()))
                    .and(col("algorithm").eq(lit(algorithm.as_str()))),
            );
            let group = group.collect()?;
            if group.height() > 0 {
                parts.push(summarize_group(settings, case, algorithm, group)?.lazy());
            }
        }
    }
    let summary = concat(parts, UnionArgs::default())?.collect()?;
    let drawn = settings.drawn_cases().map(|case| case.name());
    let is_drawn = drawn.fold(lit(false), |any, name| any.or(col("case").eq(lit(name))));
    let course = rows
        .clone()
        .lazy()
        .filter(is_drawn.and(col("seed").eq(lit(0.0))))
        .select([
            col("case"),
            col("algorithm"),
            col("time_s"),
            col("height_m"),
        ])
        .collect()?;
    Ok(Tables::from([
        ("summary".to_owned(), summary),
        ("course".to_owned(), course),
    ]))
}

/// The summary of one algorithm in one case.
fn summarize_group(
    settings: &Settings,
    case: Case,
    algorithm: &str,
    rows: DataFrame,
) -> PolarsResult<DataFrame> {
    let exact = settings.exact(case.restitution);
    // The second impact comes at 1 + 2 c times the first; the ball may be late by some steps.
    let rebound = exact.first_impact_s() * (1.0 + case.restitution);
    let late = 10.0 / f64::from(settings.frequency_hz);
    let rises = col("velocity_m_s")
        .gt(lit(0.0))
        .and(col("time_s").lt(lit(rebound + late)));
    let runs = rows.lazy().group_by_stable([col("seed")]).agg([
        col("penetration_m").max() * lit(1e3),
        col("true_penetration_m").max() * lit(1e3),
        col("height_m").filter(rises).max().alias("apex_m"),
        (col("aside_m").max() * lit(1e3)).alias("aside_mm"),
    ]);
    let mut row = df!(
        "case" => [case.name()],
        "restitution" => [case.restitution],
        "prediction_m" => [case.prediction_m],
        "algorithm" => [algorithm],
        "exact_apex_m" => [exact.first_apex_m()],
    )?;
    let of_runs = runs.select([
        col("seed").count().cast(DataType::Float64).alias("runs"),
        col("penetration_m").max().alias("penetration_mm_max"),
        col("true_penetration_m")
            .median()
            .alias("true_penetration_mm_median"),
        col("true_penetration_m")
            .max()
            .alias("true_penetration_mm_max"),
        col("apex_m").median().alias("apex_m_median"),
        col("aside_mm").median().alias("aside_mm_median"),
    ]);
    row.hstack_mut(of_runs.collect()?.columns())?;
    Ok(row)
}
