//! Summarizes the builder.

use polars::prelude::*;

use super::{ASSET, MAP, MEMORY, NARROW_GRID, SPHERES, WIDE_GRID};
use crate::data::tables::Tables;
use crate::error::Error;

/// `assets`: a row for each mesh. `maps`: a row for each encoding and store. `grids`: a row for each
/// grid and program. `spheres`, `memory`: a row each. Times are medians of all builds; errors and
/// bounds are in units of a voxel.
pub(super) fn summarize(rows: &DataFrame) -> Result<Tables, Error> {
    let of = |cases: &[&str]| {
        let is_one = |case: &&str| col("case").eq(lit(*case));
        let any = cases.iter().map(is_one).reduce(Expr::or);
        rows.clone()
            .lazy()
            .filter(any.unwrap_or(lit(false)))
            .group_by_stable([col("case"), col("algorithm")])
    };
    let first = |name: &str| col(name).first();
    let mb = |from: &str, to: &str| (first(from) * lit(1e-6)).alias(to);
    let median = |name: &str| col(name).median();
    let builds = || col("seed").count().cast(DataType::Float64).alias("builds");
    let dims = || ["voxels_x", "voxels_y", "voxels_z"].map(first);
    let voxels = || dims().into_iter().reduce(|a, b| a * b).unwrap_or(lit(0.0));
    let errors = [
        "near_bound_voxels",
        "near_error_voxels_mean",
        "near_error_voxels_max",
        "far_bound_voxels",
        "far_error_voxels_mean",
        "far_error_voxels_max",
    ];
    let assets = of(&[ASSET])
        .agg([
            first("triangles"),
            first("points"),
            builds(),
            median("distances_s"),
            median("build_s"),
            mb("tree_bytes", "tree_mb"),
        ])
        .collect()?;
    let mut of_maps = vec![
        builds(),
        median("distances_s"),
        mb("map_bytes", "map_mb"),
        mb("file_bytes", "file_mb"),
        first("quantization_voxels"),
        (first("near_error_voxels_max") - first("quantization_voxels")).alias("near_excess_voxels"),
    ];
    of_maps.extend(errors.map(first));
    let maps = of(&[MAP]).agg(of_maps).collect()?;
    let mut of_grids: Vec<_> = dims().into();
    of_grids.extend([builds(), median("distances_s")]);
    of_grids.extend(errors.map(first));
    let grids = of(&[NARROW_GRID, WIDE_GRID]).agg(of_grids).collect()?;
    let spheres = of(&[SPHERES])
        .agg([first("spheres"), first("wrong_spheres")])
        .collect()?;
    let memory = of(&[MEMORY])
        .agg([
            mb("peak_bytes", "peak_mb"),
            // Of a map that stores 16 bits for every voxel.
            (voxels() * lit(2e-6)).alias("dense_mb"),
        ])
        .collect()?
        .lazy()
        .with_column((col("peak_mb") / col("dense_mb")).alias("peak_of_dense"))
        .collect()?;
    Ok(Tables::from([
        ("assets".to_owned(), assets),
        ("maps".to_owned(), maps),
        ("grids".to_owned(), grids),
        ("spheres".to_owned(), spheres),
        ("memory".to_owned(), memory),
    ]))
}
