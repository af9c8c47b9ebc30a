//! Summarizes time-critical queries.

use polars::prelude::*;

use crate::data::tables::Tables;
use crate::error::Error;

/// `summary`: a row for each case and algorithm. Counts are sums and largest values maxima over
/// batches; medians and percentiles are medians of those of the batches.
pub(super) fn summarize(rows: &DataFrame) -> Result<Tables, Error> {
    let count = |name: &str| {
        let number = col(name).cast(DataType::Float64);
        // The sum of missing values is missing.
        when(number.clone().is_null().all(true))
            .then(lit(NULL))
            .otherwise(number.sum())
            .alias(name)
    };
    let mut columns = vec![count("poses"), count("complete")];
    for what in [
        "penetration_error_mm",
        "bound_error_mm",
        "force_error",
        "query_us",
    ] {
        columns.push(col(format!("{what}_median")).median());
        columns.push(col(format!("{what}_p99")).median());
        columns.push(col(format!("{what}_max")).max());
    }
    columns.push(count("overruns"));
    columns.push(col("overrun_us_max").max());
    columns.push(count("late_by_itself"));
    columns.push(count("idle_loops"));
    columns.push(count("idle_overruns"));
    columns.push(col("idle_overrun_us_max").max());
    let share = |of: &str, all: &str| lit(100.0) * col(of) / col(all);
    let summary = rows
        .clone()
        .lazy()
        .group_by_stable([col("case"), col("algorithm")])
        .agg(columns)
        .with_columns([
            share("complete", "poses").alias("complete_percent"),
            share("overruns", "poses").alias("overruns_percent"),
            share("idle_overruns", "idle_loops").alias("idle_overruns_percent"),
        ])
        .collect()?;
    Ok(Tables::from([("summary".to_owned(), summary)]))
}
