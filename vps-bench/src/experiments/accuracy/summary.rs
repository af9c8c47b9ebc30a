//! Summarizes errors.

use std::collections::BTreeMap;

use polars::prelude::DataFrame;
use serde::Serialize;

use super::{SHELL, Settings};
use crate::data::dataframe::{self, Row, rows};
use crate::data::stats::{Sample, power_law_exponent};
use crate::data::tables::Tables;
use crate::error::Error;

/// Errors at one size, a voxel size in mm or a number of points.
#[derive(Serialize)]
struct ErrorRow<'s> {
    shape: &'s str,
    method: &'s str,
    size: f64,
    /// The bias: reported minus exact penetration.
    error_mm_mean: Option<f64>,
    /// The standard deviation.
    error_mm_deviation: Option<f64>,
    error_mm_rms: Option<f64>,
    error_mm_abs_max: Option<f64>,
    error_bound_mm: Option<f64>,
    direction_deg_median: Option<f64>,
    direction_deg_p95: Option<f64>,
    force_error_median: Option<f64>,
    force_error_p95: Option<f64>,
    torque_error_median: Option<f64>,
}

/// Exponents of power laws in the size.
#[derive(Serialize)]
struct SlopeRow<'s> {
    shape: &'s str,
    method: &'s str,
    bias_slope: Option<f64>,
    error_slope: Option<f64>,
    direction_slope: Option<f64>,
    force_slope: Option<f64>,
    torque_slope: Option<f64>,
}

/// `field` and `field_slopes`: by voxel size. `shell` and `shell_slopes`: by number of points.
pub(super) fn summarize(settings: &Settings, records: &DataFrame) -> Result<Tables, Error> {
    let mut groups: BTreeMap<(String, String), BTreeMap<u64, Vec<Row<'_>>>> = BTreeMap::new();
    for row in rows(records) {
        let size = row.number("voxel_size_m").map(|m| m * 1e3);
        let size = size.or(row.number("points")).unwrap_or_default();
        let key = (row.text("case"), row.text("algorithm"));
        // The bits of positive numbers sort as the numbers do.
        let sizes = groups.entry(key).or_default();
        sizes.entry(size.to_bits()).or_default().push(row);
    }
    let (mut field, mut field_slopes) = (Vec::new(), Vec::new());
    let (mut shell, mut shell_slopes) = (Vec::new(), Vec::new());
    for shape in &settings.shapes {
        let methods = settings.methods.iter().map(|m| m.name());
        for method in methods.chain([SHELL]) {
            let Some(sizes) = groups.get(&(shape.name().into(), method.into())) else {
                continue;
            };
            let sizes = sizes.iter();
            let errors: Vec<_> = sizes
                .map(|(bits, rows)| {
                    summarize_group(shape.name(), method, f64::from_bits(*bits), rows)
                })
                .collect();
            let slopes = slopes(&errors);
            if method == SHELL {
                shell_slopes.extend(slopes);
                shell.extend(errors);
            } else {
                field_slopes.extend(slopes);
                field.extend(errors);
            }
        }
    }
    Ok(Tables::from([
        ("field".into(), dataframe::of(field)?),
        ("field_slopes".into(), dataframe::of(field_slopes)?),
        ("shell".into(), dataframe::of(shell)?),
        ("shell_slopes".into(), dataframe::of(shell_slopes)?),
    ]))
}

fn summarize_group<'s>(
    shape: &'s str,
    method: &'s str,
    size: f64,
    rows: &[Row<'_>],
) -> ErrorRow<'s> {
    let column = |name: &str| Sample::of(rows.iter().filter_map(|row| row.number(name)));
    let errors = || {
        rows.iter()
            .filter_map(|row| Some(row.number("error_m")? * 1e3))
    };
    let (signed, absolute) = (Sample::of(errors()), Sample::of(errors().map(f64::abs)));
    let direction = column("direction_deg");
    let (force, torque) = (column("force_error"), column("torque_error"));
    ErrorRow {
        shape,
        method,
        size,
        error_mm_mean: signed.mean(),
        error_mm_deviation: signed.standard_deviation(),
        error_mm_rms: signed.root_mean_square(),
        error_mm_abs_max: absolute.max(),
        error_bound_mm: column("error_bound_m").max().map(|m| m * 1e3),
        direction_deg_median: direction.median(),
        direction_deg_p95: direction.quantile(0.95),
        force_error_median: force.median(),
        force_error_p95: force.quantile(0.95),
        torque_error_median: torque.median(),
    }
}

fn slopes<'s>(errors: &[ErrorRow<'s>]) -> Option<SlopeRow<'s>> {
    let slope = |value: fn(&ErrorRow<'_>) -> Option<f64>| {
        power_law_exponent(
            errors
                .iter()
                .filter_map(|e| Some((e.size, value(e)?.abs()))),
        )
    };
    let first = errors.first()?;
    Some(SlopeRow {
        shape: first.shape,
        method: first.method,
        bias_slope: slope(|e| e.error_mm_mean),
        error_slope: slope(|e| e.error_mm_rms),
        direction_slope: slope(|e| e.direction_deg_median),
        force_slope: slope(|e| e.force_error_median),
        torque_slope: slope(|e| e.torque_error_median),
    })
}
