//! Presents the tables of the builder.

use polars::prelude::DataFrame;

use super::{DENSE, NARROW_GRID, SPARSE, WIDE_GRID};
use crate::data::dataframe::{Row, rows, rows_of};
use crate::data::number_format::{fixed, significant};
use crate::error::Error;
use crate::report::document::{Block, Table};
use crate::report::page::Page;

pub(super) fn present(page: &Page<'_>) -> Result<Vec<Block>, Error> {
    let mut blocks = vec![
        assets(page.table("assets")?),
        maps(page.table("maps")?),
        grids(page.table("grids")?),
    ];
    for row in rows(page.table("spheres")?) {
        blocks.push(Block::Text(format!(
            "Of {} random balls that just reach the surface, {} touch nothing by the bound of the map.",
            fixed(row.number("spheres"), 0),
            fixed(row.number("wrong_spheres"), 0),
        )));
    }
    for row in rows(page.table("memory")?) {
        blocks.push(Block::Text(format!(
            "The command `vps-build` takes {} MB at its peak for the whole asset, {} times what a dense \
             map of 16 bits would take ({} MB).",
            significant(row.number("peak_mb")),
            significant(row.number("peak_of_dense")),
            significant(row.number("dense_mb")),
        )));
    }
    Ok(blocks)
}

fn assets(assets: &DataFrame) -> Block {
    let mut table = Table::new(
        "Whole assets, reading and repairing the mesh not counted",
        &[
            "mesh",
            "triangles",
            "points",
            "distances, s",
            "whole asset, s",
            "shell and tree, MB",
        ],
    );
    for row in rows(assets) {
        table.push([
            row.text("algorithm"),
            fixed(row.number("triangles"), 0),
            fixed(row.number("points"), 0),
            significant(row.number("distances_s")),
            significant(row.number("build_s")),
            significant(row.number("tree_mb")),
        ]);
    }
    Block::Table(table)
}

/// Mean and largest error.
fn errors(row: &Row<'_>, what: &str) -> String {
    let columns = ["mean", "max"].map(|q| format!("{what}_error_voxels_{q}"));
    columns.map(|c| fixed(row.number(&c), 3)).join(" / ")
}

fn maps(maps: &DataFrame) -> Block {
    let mut table = Table::new(
        "Maps by encoding and store; errors in units of a voxel, mean / largest, near the surface and \
         elsewhere",
        &[
            "map",
            "distances, s",
            "map, MB",
            "file, MB",
            "near: bound",
            "error",
            "elsewhere: bound",
            "error",
        ],
    );
    for row in rows(maps) {
        table.push([
            row.text("algorithm").replace('_', ", "),
            significant(row.number("distances_s")),
            significant(row.number("map_mb")),
            significant(row.number("file_mb")),
            fixed(row.number("near_bound_voxels"), 3),
            errors(&row, "near"),
            fixed(row.number("far_bound_voxels"), 3),
            errors(&row, "far"),
        ]);
    }
    Block::Table(table)
}

fn grids(grids: &DataFrame) -> Block {
    let mut table = Table::new(
        "The same grid by several programs; largest errors in units of a voxel, near the surface / \
         elsewhere",
        &[
            "voxels",
            "program",
            "distances, s",
            "times as long as vps-build, sparse",
            "error",
        ],
    );
    for grid in [NARROW_GRID, WIDE_GRID] {
        let time = |row: Row<'_>| row.number("distances_s");
        let of_sparse = rows_of(grids, grid, SPARSE).next().and_then(time);
        for row in rows(grids).filter(|row| row.text("case") == grid) {
            let sides = ["voxels_x", "voxels_y", "voxels_z"];
            let program = row.text("algorithm");
            let label = match program.as_str() {
                SPARSE => "vps-build, sparse",
                DENSE => "vps-build, dense",
                other => other,
            };
            let ratio = time(row).zip(of_sparse).map(|(own, sparse)| own / sparse);
            let largest = ["near_error_voxels_max", "far_error_voxels_max"];
            table.push([
                sides.map(|side| fixed(row.number(side), 0)).join(" x "),
                label.into(),
                significant(row.number("distances_s")),
                significant(ratio),
                largest.map(|c| fixed(row.number(c), 3)).join(" / "),
            ]);
        }
    }
    Block::Table(table)
}
