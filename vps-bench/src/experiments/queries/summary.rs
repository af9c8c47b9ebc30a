//! Summarizes queries: medians of the rounds.

use polars::prelude::DataFrame;
use serde::Serialize;

use super::poses::PoseSet;
use super::query_kind::QueryKind;
use super::{CLUSTERINGS, Case, Settings};
use crate::data::dataframe::{self, rows_of};
use crate::data::stats::{Sample, power_law_exponent};
use crate::data::tables::Tables;
use crate::error::Error;
use crate::experiments::shared::query_field::QueryField;

/// Contact manifolds of one algorithm.
#[derive(Serialize)]
struct ManifoldRow<'s> {
    case: &'s str,
    algorithm: &'s str,
    query_us_median: f64,
    query_us_min: Option<f64>,
    query_us_max: Option<f64>,
}

/// One query at one set of poses.
#[derive(Serialize)]
struct FieldRow {
    case: &'static str,
    query: String,
    cuboid_us: Option<f64>,
    dense_us: Option<f64>,
    sparse_us: Option<f64>,
    sparse_by_dense: Option<f64>,
    /// Tested on the dense map.
    spheres: Option<f64>,
    points: Option<f64>,
}

/// The slowest query at one set of poses, and the largest ratio.
#[derive(Serialize)]
struct SlowestRow {
    case: &'static str,
    cuboid_us: Option<f64>,
    dense_us: Option<f64>,
    sparse_us: Option<f64>,
    sparse_by_dense: Option<f64>,
}

/// Spheres and points tested by clustering.
#[derive(Serialize)]
struct ClusteringRow {
    query: String,
    bisect_spheres: Option<f64>,
    bottom_up_spheres: Option<f64>,
    bisect_points: Option<f64>,
    bottom_up_points: Option<f64>,
}

/// One query at one size.
#[derive(Serialize)]
struct SizeRow {
    case: &'static str,
    query: String,
    size: f64,
    query_us: f64,
    contacts: Option<f64>,
}

/// One query over all sizes.
#[derive(Serialize)]
struct GrowthRow {
    case: &'static str,
    query: String,
    /// The power of the size that time grows with.
    power: Option<f64>,
    /// The longest time by the shortest.
    largest_ratio: Option<f64>,
}

/// The records of all rounds.
struct Records<'r> {
    rows: &'r DataFrame,
}

impl Records<'_> {
    /// Values of a column in all rounds.
    fn of(&self, case: Case, what: &str, query: &str, column: &str) -> Sample {
        let rows = rows_of(self.rows, case.name(), what).filter(|row| row.text("query") == query);
        Sample::of(rows.filter_map(|row| row.number(column)))
    }

    fn median(&self, case: Case, what: &str, query: &str, column: &str) -> Option<f64> {
        self.of(case, what, query, column).median()
    }
}

/// `manifolds`: a row for each algorithm, on the ground and interlocked. `fields`: a row for each
/// query at each set of poses; `slowest`: the slowest of them. `clusterings`: a row for each query.
/// `sizes`: a row for each size; `growth`: a row for each query.
pub(super) fn summarize(settings: &Settings, rows: &DataFrame) -> Result<Tables, Error> {
    let records = Records { rows };
    let fields: Vec<_> = PoseSet::ALL
        .into_iter()
        .flat_map(|set| QueryKind::ALL.map(|kind| records.field_row(set, kind)))
        .collect();
    let slowest = PoseSet::ALL.map(|set| slowest(set, &fields));
    let sizes = records.sizes(settings);
    let growth = growth(&sizes);
    let (manifolds, clusterings) = (records.manifolds(settings), records.clusterings());
    Ok(Tables::from([
        ("manifolds".into(), dataframe::of(manifolds)?),
        ("fields".into(), dataframe::of(fields)?),
        ("slowest".into(), dataframe::of(slowest)?),
        ("clusterings".into(), dataframe::of(clusterings)?),
        ("sizes".into(), dataframe::of(sizes)?),
        ("growth".into(), dataframe::of(growth)?),
    ]))
}

impl Records<'_> {
    fn manifolds<'s>(&self, settings: &'s Settings) -> Vec<ManifoldRow<'s>> {
        let on_ground = settings.algorithms.iter().map(|a| (Case::Manifolds, a));
        let interlocked = [&settings.shell, &settings.trimesh].map(|a| (Case::Interlocked, a));
        let row = |(case, algorithm): (Case, &'s String)| {
            let times = self.of(case, algorithm, super::measure::MANIFOLDS, "time_us");
            Some(ManifoldRow {
                case: case.name(),
                algorithm,
                query_us_median: times.median()?,
                query_us_min: times.min(),
                query_us_max: times.max(),
            })
        };
        on_ground.chain(interlocked).filter_map(row).collect()
    }

    fn field_row(&self, set: PoseSet, kind: QueryKind) -> FieldRow {
        let (case, query) = (Case::Fields(set), kind.name());
        let [cuboid_us, dense_us, sparse_us] =
            QueryField::ALL.map(|field| self.median(case, field.name(), &query, "time_us"));
        let [spheres, points] = ["spheres", "points"]
            .map(|column| self.median(case, QueryField::Dense.name(), &query, column));
        FieldRow {
            case: set.name(),
            cuboid_us,
            dense_us,
            sparse_us,
            sparse_by_dense: sparse_us
                .zip(dense_us)
                .map(|(sparse, dense)| sparse / dense),
            spheres,
            points,
            query,
        }
    }

    fn clusterings(&self) -> [ClusteringRow; 10] {
        QueryKind::ALL.map(|kind| {
            let query = kind.name();
            let tested =
                |column| CLUSTERINGS.map(|name| self.median(Case::Clusters, name, &query, column));
            let [bisect_spheres, bottom_up_spheres] = tested("spheres");
            let [bisect_points, bottom_up_points] = tested("points");
            ClusteringRow {
                bisect_spheres,
                bottom_up_spheres,
                bisect_points,
                bottom_up_points,
                query,
            }
        })
    }

    fn sizes(&self, settings: &Settings) -> Vec<SizeRow> {
        let mut sizes = Vec::new();
        let cases = [
            (Case::Points, &QueryKind::BY_POINTS[..]),
            (Case::Triangles, &QueryKind::BY_TRIANGLES),
        ];
        for (case, kinds) in cases {
            for query in kinds.iter().map(|kind| kind.name()) {
                for what in settings.compared(case) {
                    let median = |column| self.median(case, &what, &query, column);
                    sizes.extend(
                        median("size")
                            .zip(median("time_us"))
                            .map(|(size, query_us)| SizeRow {
                                case: case.name(),
                                query: query.clone(),
                                size,
                                query_us,
                                contacts: median("contacts"),
                            }),
                    );
                }
            }
        }
        sizes
    }
}

fn slowest(set: PoseSet, fields: &[FieldRow]) -> SlowestRow {
    let largest = |column: fn(&FieldRow) -> Option<f64>| {
        let of_set = fields.iter().filter(|row| row.case == set.name());
        Sample::of(of_set.filter_map(column)).max()
    };
    SlowestRow {
        case: set.name(),
        cuboid_us: largest(|row| row.cuboid_us),
        dense_us: largest(|row| row.dense_us),
        sparse_us: largest(|row| row.sparse_us),
        sparse_by_dense: largest(|row| row.sparse_by_dense),
    }
}

fn growth(sizes: &[SizeRow]) -> Vec<GrowthRow> {
    let of_query = sizes.chunk_by(|a, b| (a.case, &a.query) == (b.case, &b.query));
    let row = |sizes: &[SizeRow]| {
        let times = Sample::of(sizes.iter().map(|row| row.query_us));
        GrowthRow {
            case: sizes[0].case,
            query: sizes[0].query.clone(),
            power: power_law_exponent(sizes.iter().map(|row| (row.size, row.query_us))),
            largest_ratio: times.max().zip(times.min()).map(|(max, min)| max / min),
        }
    };
    of_query.map(row).collect()
}
