//! Summarizes builds.

use polars::prelude::*;

use super::SHELLS;
use crate::data::tables::Tables;
use crate::error::Error;
use crate::experiments::shared::voxelmaps::VOXELMAPS;

/// `voxelmaps`: a row for each encoding and density. `pointshells`: a row for each shell and
/// clustering. `levels`: a row for each of their levels. Times are medians of all builds.
pub(super) fn summarize(rows: &DataFrame) -> Result<Tables, Error> {
    let of = |cases: &[&str]| {
        let is_one = |case: &&str| col("case").eq(lit(*case));
        let any = cases.iter().map(is_one).reduce(Expr::or);
        rows.clone().lazy().filter(any.unwrap_or(lit(false)))
    };
    let whole = || col("level").eq(lit(0.0));
    let first = |name: &str| col(name).first();
    let scaled = |from: &str, factor: f64, to: &str| (first(from) * lit(factor)).alias(to);
    let median = |name: &str| col(name).median();
    let maps = VOXELMAPS.map(|(case, _)| case);
    let voxelmaps = of(&maps)
        .filter(whole())
        .group_by_stable([col("case")])
        .agg([
            first("voxels_x"),
            first("voxels_y"),
            first("voxels_z"),
            (first("voxels_x") * first("voxels_y") * first("voxels_z")).alias("voxels"),
            first("values"),
            scaled("map_bytes", 1e-6, "map_mb"),
            scaled("near_error_m", 1e3, "near_error_mm"),
            scaled("far_error_m", 1e3, "far_error_mm"),
            col("case").count().cast(DataType::Float64).alias("builds"),
            median("voxels_s"),
            median("distances_s"),
            (col("voxels_s") + col("distances_s"))
                .median()
                .alias("build_s"),
        ])
        .collect()?;
    let pointshells = of(&SHELLS)
        .filter(whole())
        .group_by_stable([col("algorithm"), col("case")])
        .agg([
            first("points"),
            first("levels"),
            scaled("tree_bytes", 1e-6, "tree_mb"),
            scaled("file_bytes", 1e-6, "file_mb"),
            col("case").count().cast(DataType::Float64).alias("builds"),
            median("points_s"),
            median("tree_s"),
            (col("points_s") + col("tree_s")).median().alias("build_s"),
            (col("voxels_s") + col("distances_s") + col("points_s") + col("tree_s"))
                .median()
                .alias("asset_build_s"),
        ])
        .collect()?;
    // Of the first build only: other seeds give other trees.
    let levels = of(&SHELLS)
        .filter(whole().not().and(col("seed").eq(lit(0.0))))
        .select([
            col("algorithm"),
            col("case"),
            col("level"),
            col("clusters"),
            col("children_mean"),
            col("children_max"),
            (col("radius_m_mean") * lit(1e3)).alias("radius_mm_mean"),
            (col("radius_m_max") * lit(1e3)).alias("radius_mm_max"),
        ])
        .collect()?;
    Ok(Tables::from([
        ("voxelmaps".to_owned(), voxelmaps),
        ("pointshells".to_owned(), pointshells),
        ("levels".to_owned(), levels),
    ]))
}
