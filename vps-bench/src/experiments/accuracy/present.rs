//! Presents the tables of errors.

use polars::prelude::DataFrame;

use super::{Method, SHELL, Settings};
use crate::data::dataframe::{Row, rows};
use crate::data::number_format::{fixed, significant};
use crate::error::Error;
use crate::experiments::shared::power_law::{Labels, Series, color, figure};
use crate::report::document::{Block, Table};
use crate::report::page::Page;

pub(super) fn present(settings: &Settings, page: &Page<'_>) -> Result<Vec<Block>, Error> {
    let (field, shell) = (page.table("field")?, page.table("shell")?);
    let shapes: Vec<_> = settings.shapes.iter().map(|s| s.name()).collect();
    let mut blocks = vec![
        slopes("Slopes by voxel size", page.table("field_slopes")?),
        slopes("Slopes by number of points", page.table("shell_slopes")?),
        values("Voxelmaps by voxel size", "voxel, mm", field),
        values("Pointshells by number of points", "points", shell),
    ];
    let by_method = |shape: &str, column: &str| {
        let series = |(i, method): (usize, &Method)| Series {
            label: method.label().into(),
            color: color(i),
            points: points(field, shape, method.name(), column),
        };
        settings
            .methods
            .iter()
            .enumerate()
            .map(series)
            .collect::<Vec<_>>()
    };
    let by_shape = |column: &str| {
        let series = |(i, shape): (usize, &&str)| Series {
            label: (*shape).to_owned(),
            color: color(i),
            points: points(shell, shape, SHELL, column),
        };
        shapes.iter().enumerate().map(series).collect::<Vec<_>>()
    };
    for shape in &shapes {
        if points(field, shape, Method::Trilinear.name(), "error_mm_rms").is_empty() {
            continue;
        }
        let labels = Labels {
            stem: &format!("field_{shape}"),
            title: &format!("Error of penetration in the voxelmap of a {shape}"),
            x: "voxel size (mm)",
            y: "root mean square error (mm)",
        };
        blocks.push(figure(&labels, by_method(shape, "error_mm_rms"), page)?);
        let labels = Labels {
            stem: &format!("field_force_{shape}"),
            title: &format!("Error of the force on a cube in the voxelmap of a {shape}"),
            x: "voxel size (mm)",
            y: "median error / force",
        };
        blocks.push(figure(
            &labels,
            by_method(shape, "force_error_median"),
            page,
        )?);
    }
    let of_shells = [
        (
            "shell_depth",
            "Error of penetration of a pointshell in a half-space",
            "root mean square error (mm)",
            "error_mm_rms",
        ),
        (
            "shell_force",
            "Error of the force on a pointshell in a half-space",
            "median error / force",
            "force_error_median",
        ),
        (
            "shell_torque",
            "Error of the torque on a pointshell in a half-space",
            "median error / (force x half width)",
            "torque_error_median",
        ),
    ];
    for (stem, title, y, column) in of_shells {
        let labels = Labels {
            stem,
            title,
            x: "points",
            y,
        };
        blocks.push(figure(&labels, by_shape(column), page)?);
    }
    Ok(blocks)
}

/// Values of a column by size.
fn points(dataframe: &DataFrame, shape: &str, method: &str, column: &str) -> Vec<(f64, f64)> {
    let group = rows(dataframe).filter(|r| r.text("shape") == shape && r.text("method") == method);
    group
        .filter_map(|row| Some((row.number("size")?, row.number(column)?)))
        .collect()
}

/// The label of a method.
fn label(row: &Row<'_>) -> String {
    let name = row.text("method");
    let method = Method::ALL.into_iter().find(|m| m.name() == name);
    method.map_or(name, |m| m.label().into())
}

fn slopes(caption: &str, dataframe: &DataFrame) -> Block {
    let head = [
        "shape",
        "method",
        "bias",
        "error",
        "direction",
        "force",
        "torque",
    ];
    let mut table = Table::new(caption, &head);
    for row in rows(dataframe) {
        let columns = ["bias", "error", "direction", "force", "torque"];
        let slopes = columns.map(|c| fixed(row.number(&format!("{c}_slope")), 2));
        table.push([row.text("shape"), label(&row)].into_iter().chain(slopes));
    }
    Block::Table(table)
}

fn values(caption: &str, size: &str, dataframe: &DataFrame) -> Block {
    let head = [
        "shape",
        "method",
        size,
        "bias, mm",
        "spread, mm",
        "largest error, mm",
        "stated bound, mm",
        "direction: median, °",
        "p95, °",
        "force error",
        "torque error",
    ];
    let mut table = Table::new(caption, &head);
    for row in rows(dataframe) {
        let columns = [
            "error_mm_mean",
            "error_mm_deviation",
            "error_mm_abs_max",
            "error_bound_mm",
            "direction_deg_median",
            "direction_deg_p95",
            "force_error_median",
            "torque_error_median",
        ];
        let numbers = columns.map(|c| significant(row.number(c)));
        let size = row.text("size");
        let names = [row.text("shape"), label(&row), size];
        table.push(names.into_iter().chain(numbers));
    }
    Block::Table(table)
}
