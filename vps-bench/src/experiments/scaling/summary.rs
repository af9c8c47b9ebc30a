//! Tables of times by size.

use std::collections::BTreeMap;

use polars::prelude::DataFrame;
use serde::Serialize;

use super::{Case, Settings};
use crate::claims::Tables;
use crate::experiments::Error;
use crate::frame::{self, Row, rows};
use crate::stats::{Sample, exponent};

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
    /// Of the median time over the size.
    slope: Option<f64>,
    /// Of the median time over the contacts.
    slope_by_contacts: Option<f64>,
}

/// `times`: a row a size. `slopes`: a row a case and algorithm.
pub(super) fn summarize(settings: &Settings, frame: &DataFrame) -> Result<Tables, Error> {
    let mut groups: BTreeMap<(String, String), BTreeMap<u64, Vec<Row<'_>>>> = BTreeMap::new();
    for row in rows(frame) {
        let size = row.number("size").unwrap_or_default();
        let key = (row.text("case"), row.text("algorithm"));
        // Bits of positive numbers have their order.
        let sizes = groups.entry(key).or_default();
        sizes.entry(size.to_bits()).or_default().push(row);
    }
    let (mut times, mut slopes) = (Vec::new(), Vec::new());
    for case in Case::ALL {
        for algorithm in settings.names(case) {
            let Some(sizes) = groups.get(&(case.name().into(), algorithm.into())) else {
                continue;
            };
            let of_it: Vec<_> = sizes
                .iter()
                .map(|(bits, rows)| of_one(case, algorithm, f64::from_bits(*bits), rows))
                .collect();
            let pairs = |x: fn(&SizeRow<'_>) -> Option<f64>| {
                exponent(
                    of_it
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
            times.extend(of_it);
        }
    }
    Ok(Tables::from([
        ("times".into(), frame::of(times)?),
        ("slopes".into(), frame::of(slopes)?),
    ]))
}

fn of_one<'s>(case: Case, algorithm: &'s str, size: f64, rows: &[Row<'_>]) -> SizeRow<'s> {
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
    /// What takes part in a case, in the order of tables.
    pub(super) fn names(&self, case: Case) -> Vec<&str> {
        if case == Case::Bodies {
            return self.bodies.algorithms.iter().map(String::as_str).collect();
        }
        case.asks().iter().map(|ask| ask.name()).collect()
    }
}
