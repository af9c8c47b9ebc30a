//! Summarizes falls.

use std::collections::BTreeMap;

use polars::prelude::*;
use serde::Serialize;

use super::{Settings, Show};
use crate::data::dataframe::{self, rows};
use crate::data::stats::power_spectrum;
use crate::data::tables::Tables;
use crate::error::Error;

/// `summary`: a row for each case and algorithm. `course`: the medians over all orientations, a row
/// for each step. If spin is shown, of the measured steps: `spectrum`, a row for each frequency,
/// and `turning`, a row for each case and algorithm.
pub(super) fn summarize(settings: &Settings, rows: &DataFrame) -> Result<Tables, Error> {
    let mut parts = Vec::new();
    let (mut spectrum, mut turning) = (Vec::new(), Vec::new());
    let is_spectrum_shown = settings.show.contains(&Show::Spin);
    for &frequency in &settings.frequencies_hz {
        let case = Settings::case(frequency);
        let of_case = rows.clone().lazy().filter(col("case").eq(lit(case)));
        for algorithm in &settings.algorithms {
            let group = of_case
                .clone()
                .filter(col("algorithm").eq(lit(algorithm.as_str())));
            let group = group.collect()?;
            if group.height() > 0 {
                parts.push(summarize_group(settings, frequency, algorithm, &group)?);
                if is_spectrum_shown {
                    let group = spectrum_of(settings, frequency, algorithm, &group);
                    turning.extend(TurningRow::of(&group));
                    spectrum.extend(group);
                }
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
    let mut tables = Tables::from([
        ("summary".to_owned(), summary),
        ("course".to_owned(), course),
    ]);
    if is_spectrum_shown {
        tables.insert("spectrum".into(), dataframe::of(spectrum)?);
        tables.insert("turning".into(), dataframe::of(turning)?);
    }
    Ok(tables)
}

/// The power of the angular velocity at a frequency.
#[derive(Serialize)]
struct SpectrumRow {
    case: String,
    algorithm: String,
    turning_hz: f64,
    /// Mean of all start orientations, summed over the axes.
    power_rad2_s2_per_hz: f64,
}

/// The total power of the angular velocity, and the part above [`FAST_HZ`].
#[derive(Serialize)]
struct TurningRow {
    case: String,
    algorithm: String,
    power_rad2_s2: f64,
    power_above_20_hz_rad2_s2: f64,
}

/// Frequencies above this are faster than any body rolls, in Hz.
const FAST_HZ: f64 = 20.0;

impl TurningRow {
    /// `None` of an empty spectrum.
    fn of(spectrum: &[SpectrumRow]) -> Option<Self> {
        let lowest = spectrum.first()?;
        let above = |hz: f64| {
            let above = spectrum.iter().filter(|row| row.turning_hz > hz);
            above.map(|row| row.power_rad2_s2_per_hz).sum::<f64>() * lowest.turning_hz
        };
        Some(Self {
            case: lowest.case.clone(),
            algorithm: lowest.algorithm.clone(),
            power_rad2_s2: above(0.0),
            power_above_20_hz_rad2_s2: above(FAST_HZ),
        })
    }
}

/// The spectrum of the angular velocity in the measured steps, of one algorithm at one frequency.
fn spectrum_of(
    settings: &Settings,
    frequency: u32,
    algorithm: &str,
    steps: &DataFrame,
) -> Vec<SpectrumRow> {
    const AXES: [&str; 3] = [
        "angular_velocity_x_rad_s",
        "angular_velocity_y_rad_s",
        "angular_velocity_z_rad_s",
    ];
    let [from, to] = settings.measured_steps(frequency).map(f64::from);
    // By seed, then by axis.
    let mut turns = BTreeMap::<String, [Vec<f64>; 3]>::new();
    for row in rows(steps) {
        let step = row.number("step").unwrap_or_default();
        if from <= step && step < to {
            let of_seed = turns.entry(row.text("seed")).or_default();
            for (values, axis) in of_seed.iter_mut().zip(AXES) {
                values.push(row.number(axis).unwrap_or_default());
            }
        }
    }
    let spectra = turns.values().flatten();
    let spectra: Vec<_> = spectra
        .map(|values| power_spectrum(values, 1.0 / f64::from(frequency)))
        .collect();
    let frequencies = spectra.first().into_iter().flatten().enumerate();
    let mean = frequencies.map(|(i, (turning_hz, _))| {
        let powers = spectra.iter().filter_map(|s| s.get(i));
        let total = powers.map(|(_, power)| power).sum::<f64>();
        SpectrumRow {
            case: Settings::case(frequency),
            algorithm: algorithm.into(),
            turning_hz: *turning_hz,
            power_rad2_s2_per_hz: total / turns.len() as f64,
        }
    });
    mean.collect()
}

/// Query times in µs; missing in steps without a query.
fn query_us() -> Expr {
    let time = col("query_ns") * lit(1e-3);
    when(col("queries").gt(lit(0)))
        .then(time)
        .otherwise(lit(NULL))
        .alias("query_us")
}

/// The summary of one algorithm at one frequency.
fn summarize_group(
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
    // Steps in which the body rolls; a body at rest does not count.
    let rolls = col("angular_velocity_rad_s").gt(lit(ROLLING_RAD_S));
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
    // The upper side of the ground is at height 0: a body with its origin below fell through.
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

/// Least angular velocity of a rolling body, in rad/s.
const ROLLING_RAD_S: f64 = 0.2;
