//! Tables of records.

use polars::prelude::*;
use serde::{Deserialize, Serialize};

use crate::config::Experiment;
use crate::records::StepRow;

/// What one algorithm did in the measured steps of all orientations.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub(crate) struct SummaryRow {
    pub(crate) algorithm: String,
    pub(crate) label: String,
    /// Steps with a query.
    pub(crate) queries: u64,
    pub(crate) query_us_min: f64,
    pub(crate) query_us_median: f64,
    pub(crate) query_us_mean: f64,
    pub(crate) query_us_p95: f64,
    pub(crate) query_us_p99: f64,
    pub(crate) query_us_max: f64,
    pub(crate) paper_query_us: Option<f64>,
    pub(crate) contacts_mean: f64,
    /// Deepest of all steps, also those before the measured ones, as the algorithm sees it.
    pub(crate) penetration_mm_max: f64,
    /// And as it was.
    pub(crate) true_penetration_mm_max: f64,
    pub(crate) linear_velocity_m_s_mean: f64,
    pub(crate) kinetic_energy_j_mean: f64,
}

/// The medians over all orientations in one step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StepMedian {
    pub(crate) step: u32,
    /// Of those orientations in which there was a query.
    pub(crate) query_us: Option<f64>,
    pub(crate) linear_velocity_m_s: f64,
}

/// The rows as columns, for all tables made from them.
pub(crate) fn frame(rows: &[StepRow]) -> PolarsResult<DataFrame> {
    let numbers = |f: fn(&StepRow) -> Option<f64>| rows.iter().map(f).collect::<Vec<_>>();
    let names: Vec<_> = rows.iter().map(|r| r.algorithm.as_str()).collect();
    let steps: Vec<_> = rows.iter().map(|r| r.step).collect();
    df!(
        "algorithm" => names,
        "step" => steps,
        "query_us" => numbers(|r| (r.queries > 0).then_some(r.query_ns as f64 * 1e-3)),
        "contacts" => numbers(|r| Some(r.contacts as f64)),
        "penetration_mm" => numbers(|r| r.penetration_m.map(|p| f64::from(p) * 1e3)),
        "true_penetration_mm" => numbers(|r| Some(f64::from(r.true_penetration_m) * 1e3)),
        "linear_velocity_m_s" => numbers(|r| Some(f64::from(r.linear_velocity_m_s))),
        "kinetic_energy_j" => numbers(|r| Some(f64::from(r.kinetic_energy_j))),
    )
}

/// One row an algorithm, in the order of the experiment; algorithms without a row are left out.
pub(crate) fn summarize(
    experiment: &Experiment,
    steps: &DataFrame,
) -> PolarsResult<Vec<SummaryRow>> {
    let [from, to] = experiment.runs.measured_steps;
    let all = steps.clone().lazy();
    let quantile = |q: f64| col("query_us").quantile(lit(q), QuantileMethod::Linear);
    let measured = all
        .clone()
        .filter(col("step").gt_eq(lit(from)).and(col("step").lt(lit(to))))
        .group_by([col("algorithm")])
        .agg([
            col("query_us")
                .count()
                .cast(DataType::Float64)
                .alias("queries"),
            col("query_us").min().alias("min"),
            col("query_us").median().alias("median"),
            col("query_us").mean().alias("mean"),
            quantile(0.95).alias("p95"),
            quantile(0.99).alias("p99"),
            col("query_us").max().alias("max"),
            col("contacts").mean(),
            col("linear_velocity_m_s").mean(),
            col("kinetic_energy_j").mean(),
        ])
        .collect()?;
    let whole = all
        .group_by([col("algorithm")])
        .agg([
            col("penetration_mm").max(),
            col("true_penetration_mm").max(),
        ])
        .collect()?;
    let value = |frame: &DataFrame, algorithm: &str, column: &str| -> PolarsResult<Option<f64>> {
        let names = frame.column("algorithm")?.str()?;
        let row = names.iter().position(|name| name == Some(algorithm));
        Ok(match row {
            Some(row) => frame.column(column)?.f64()?.get(row),
            None => None,
        })
    };
    let mut summary = Vec::new();
    for algorithm in &experiment.algorithm {
        let name = algorithm.name.as_str();
        let Some(queries) = value(&measured, name, "queries")? else {
            continue;
        };
        let or_nan = |frame: &DataFrame, column: &str| -> PolarsResult<f64> {
            Ok(value(frame, name, column)?.unwrap_or(f64::NAN))
        };
        let of = |column| or_nan(&measured, column);
        let of_whole = |column| or_nan(&whole, column);
        summary.push(SummaryRow {
            algorithm: name.into(),
            label: algorithm.label.clone(),
            queries: queries as u64,
            query_us_min: of("min")?,
            query_us_median: of("median")?,
            query_us_mean: of("mean")?,
            query_us_p95: of("p95")?,
            query_us_p99: of("p99")?,
            query_us_max: of("max")?,
            paper_query_us: experiment.paper_value(name).map(|v| v.query_us),
            contacts_mean: of("contacts")?,
            penetration_mm_max: of_whole("penetration_mm")?,
            true_penetration_mm_max: of_whole("true_penetration_mm")?,
            linear_velocity_m_s_mean: of("linear_velocity_m_s")?,
            kinetic_energy_j_mean: of("kinetic_energy_j")?,
        });
    }
    Ok(summary)
}

/// The course of one algorithm over the steps.
pub(crate) fn course(steps: &DataFrame, algorithm: &str) -> PolarsResult<Vec<StepMedian>> {
    let medians = steps
        .clone()
        .lazy()
        .filter(col("algorithm").eq(lit(algorithm)))
        .group_by([col("step")])
        .agg([
            col("query_us").median(),
            col("linear_velocity_m_s").median(),
        ])
        .sort(["step"], SortMultipleOptions::default())
        .collect()?;
    let steps = medians.column("step")?.u32()?;
    let times = medians.column("query_us")?.f64()?;
    let velocities = medians.column("linear_velocity_m_s")?.f64()?;
    Ok((0..medians.height())
        .map(|i| StepMedian {
            step: steps.get(i).unwrap_or_default(),
            query_us: times.get(i),
            linear_velocity_m_s: velocities.get(i).unwrap_or(f64::NAN),
        })
        .collect())
}
