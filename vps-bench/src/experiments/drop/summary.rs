//! Tables of what bodies did.

use polars::prelude::*;

use super::Settings;
use crate::claims::Tables;
use crate::experiments::Error;

/// `summary`: a row a case and algorithm. `course`: the medians over all orientations, a row a step.
pub(super) fn summarize(settings: &Settings, rows: &DataFrame) -> Result<Tables, Error> {
    let mut parts = Vec::new();
    for &frequency in &settings.frequencies_hz {
        let case = Settings::case(frequency);
        let of_case = rows.clone().lazy().filter(col("case").eq(lit(case)));
        for algorithm in &settings.algorithms {
            let of_both = of_case
                .clone()
                .filter(col("algorithm").eq(lit(algorithm.as_str())));
            let of_both = of_both.collect()?;
            if of_both.height() > 0 {
                parts.push(of_one(settings, frequency, algorithm, &of_both)?);
            }
        }
    }
    let summary = concat(parts, UnionArgs::default())?.collect()?;
    let course = rows
        .clone()
        .lazy()
        .group_by_stable([col("case"), col("algorithm"), col("step")])
        .agg([
            query_us().median(),
            col("linear_velocity_m_s").median(),
            (col("kinetic_energy_j") * lit(1e3))
                .median()
                .alias("kinetic_energy_mj"),
        ])
        .collect()?;
    Ok(Tables::from([
        ("summary".to_owned(), summary),
        ("course".to_owned(), course),
    ]))
}

/// Times of steps with a query.
fn query_us() -> Expr {
    let time = col("query_ns") * lit(1e-3);
    when(col("queries").gt(lit(0)))
        .then(time)
        .otherwise(lit(NULL))
        .alias("query_us")
}

/// What one algorithm did at one frequency.
fn of_one(
    settings: &Settings,
    frequency: u32,
    algorithm: &str,
    rows: &DataFrame,
) -> PolarsResult<LazyFrame> {
    let [from, to] = settings.measured_steps(frequency);
    let all = rows.clone().lazy();
    let measured = all
        .clone()
        .filter(col("step").gt_eq(lit(from)).and(col("step").lt(lit(to))));
    let time = |what: fn(Expr) -> Expr, name: &str| what(query_us()).alias(name);
    let quantile = |q: f64, name: &str| {
        query_us()
            .quantile(lit(q), QuantileMethod::Linear)
            .alias(name)
    };
    // What rolls turns; what lies there does not count.
    let rolls = col("angular_velocity_rad_s").gt(lit(ROLLS_RAD_S));
    let change = || col("spin_change_rad_s").filter(rolls.clone());
    let measured = measured.select([
        query_us().count().cast(DataType::Float64).alias("queries"),
        time(Expr::min, "query_us_min"),
        time(Expr::median, "query_us_median"),
        time(Expr::mean, "query_us_mean"),
        quantile(0.95, "query_us_p95"),
        quantile(0.99, "query_us_p99"),
        time(Expr::max, "query_us_max"),
        col("contacts").mean().alias("contacts_mean"),
        col("linear_velocity_m_s")
            .mean()
            .alias("linear_velocity_m_s_mean"),
        (col("kinetic_energy_j") * lit(1e3))
            .mean()
            .alias("kinetic_energy_mj_mean"),
        change()
            .count()
            .cast(DataType::Float64)
            .alias("rolling_steps"),
        change().median().alias("spin_change_rad_s_median"),
        change()
            .quantile(lit(0.99), QuantileMethod::Linear)
            .alias("spin_change_rad_s_p99"),
    ]);
    let whole = all.clone().select([
        (col("penetration_m").max() * lit(1e3)).alias("penetration_mm_max"),
        (col("true_penetration_m").max() * lit(1e3)).alias("true_penetration_mm_max"),
    ]);
    // The ground's upper side is at height 0: a body with its origin below is through.
    let ends = all
        .group_by_stable([col("seed")])
        .agg([col("y_m")
            .last()
            .lt(lit(0.0))
            .cast(DataType::Float64)
            .alias("fell")])
        .select([
            col("fell").count().cast(DataType::Float64).alias("runs"),
            col("fell").sum().alias("fell_through"),
        ]);
    let names = df!(
        "case" => [Settings::case(frequency)],
        "frequency_hz" => [f64::from(frequency)],
        "algorithm" => [algorithm],
    )?;
    let mut row = names;
    for part in [measured.collect()?, whole.collect()?, ends.collect()?] {
        row.hstack_mut(part.columns())?;
    }
    Ok(row.lazy())
}

/// From this angular velocity on a body rolls, in rad/s.
const ROLLS_RAD_S: f64 = 0.2;
