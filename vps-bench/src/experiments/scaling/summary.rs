//! Summarizes times by size.

use std::collections::BTreeMap;

use polars::prelude::DataFrame;
use serde::Serialize;

use super::{Case, Settings};
use crate::data::dataframe::{self, Row, rows};
use crate::data::stats::{Sample, power_law_exponent};
use crate::data::tables::Tables;
use crate::error::Error;

#[derive(Serialize)]
struct SizeRow<'s> {
    case: &'s str,
    algorithm: &'s str,
    size: f64,
    time_us_median: Option<f64>,
    time_us_mean: Option<f64>,
    time_us_p95: Option<f64>,
    contacts_mean: Option<f64>,
}

#[derive(Serialize)]
struct SlopeRow<'s> {
    case: &'s str,
    algorithm: &'s str,
    /// Exponent of the median time by size.
    slope: Option<f64>,
    /// Exponent of the median time by contacts.
    slope_by_contacts: Option<f64>,
}

/// `times`: a row for each size. `slopes`: a row for each case and algorithm.
pub(super) fn summarize(settings: &Settings, records: &DataFrame) -> Result<Tables, Error> {
    let mut groups: BTreeMap<(String, String), BTreeMap<u64, Vec<Row<'_>>>> = BTreeMap::new();
    for row in rows(records) {
        let size = row.number("size").unwrap_or_default();
        let key = (row.text("case"), row.text("algorithm"));
        // The bits of positive numbers sort as the numbers do.
        let sizes = groups.entry(key).or_default();
        sizes.entry(size.to_bits()).or_default().push(row);
    }
    let (mut times, mut slopes) = (Vec::new(), Vec::new());
    for case in Case::ALL {
        for algorithm in settings.names(case) {
            let Some(sizes) = groups.get(&(case.name().into(), algorithm.into())) else {
                continue;
            };
            let group: Vec<_> = sizes
                .iter()
                .map(|(bits, rows)| summarize_size(case, algorithm, f64::from_bits(*bits), rows))
                .collect();
            let pairs = |x: fn(&SizeRow<'_>) -> Option<f64>| {
                power_law_exponent(
                    group
                        .iter()
                        .filter_map(|r| Some((x(r)?, r.time_us_median?))),
                )
            };
            slopes.push(SlopeRow {
                case: case.name(),
                algorithm,
                slope: pairs(|r| Some(r.size)),
                slope_by_contacts: pairs(|r| r.contacts_mean),
            });
            times.extend(group);
        }
    }
    Ok(Tables::from([
        ("times".into(), dataframe::of(times)?),
        ("slopes".into(), dataframe::of(slopes)?),
    ]))
}

fn summarize_size<'s>(case: Case, algorithm: &'s str, size: f64, rows: &[Row<'_>]) -> SizeRow<'s> {
    let column = |name: &str| Sample::of(rows.iter().filter_map(|row| row.number(name)));
    let times = column("time_us");
    SizeRow {
        case: case.name(),
        algorithm,
        size,
        time_us_median: times.median(),
        time_us_mean: times.mean(),
        time_us_p95: times.quantile(0.95),
        contacts_mean: column("contacts").mean(),
    }
}

impl Settings {
    /// Queries or algorithms of a case, in the order of tables.
    pub(super) fn names(&self, case: Case) -> Vec<&str> {
        if case == Case::Bodies {
            return self.bodies.algorithms.iter().map(String::as_str).collect();
        }
        case.queries().iter().map(|kind| kind.name()).collect()
    }
}
