//! Summarizes stacks.

use polars::prelude::*;

use super::Settings;
use crate::data::tables::Tables;
use crate::error::Error;

/// `summary`: a row for each case and algorithm, over all stacks. `runs`: a row for each stack.
pub(super) fn summarize(settings: &Settings, rows: &DataFrame) -> Result<Tables, Error> {
    let quantile = |q: f64, name: &str| {
        col("stood_s")
            .quantile(lit(q), QuantileMethod::Linear)
            .alias(name)
    };
    let mut summary = rows
        .clone()
        .lazy()
        .group_by_stable([col("case"), col("algorithm")])
        .agg([
            col("stood_s")
                .count()
                .cast(DataType::Float64)
                .alias("stacks"),
            col("fell").sum(),
            col("stood_s").median().alias("stood_s_median"),
            quantile(0.25, "stood_s_p25"),
            quantile(0.75, "stood_s_p75"),
            (col("true_penetration_m_max") * lit(1e3))
                .max()
                .alias("true_penetration_mm_max"),
            (col("sway_m_max") * lit(1e3))
                .median()
                .alias("sway_mm_median"),
        ])
        .collect()?;
    // The time limit, without which a time means little.
    let limit = Column::new(
        "limit_s".into(),
        vec![settings.duration_s; summary.height()],
    );
    summary.hstack_mut(&[limit])?;
    Ok(Tables::from([
        ("summary".to_owned(), summary),
        ("runs".to_owned(), rows.clone()),
    ]))
}
