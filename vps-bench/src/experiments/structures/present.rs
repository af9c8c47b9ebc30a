//! Presents the tables of builds, and the pictures.

use super::pictures::PICTURES;
use super::{SHELLS, Settings};
use crate::data::dataframe::{Row, rows};
use crate::data::number_format::{fixed, significant};
use crate::error::Error;
use crate::report::document::{Block, FigureLink, Table};
use crate::report::page::Page;

pub(super) fn present(settings: &Settings, page: &Page<'_>) -> Result<Vec<Block>, Error> {
    let mut blocks = vec![Block::Table(voxelmaps(rows(page.table("voxelmaps")?)))];
    let shells = rows(page.table("pointshells")?);
    blocks.push(Block::Table(pointshells(shells, page)?));
    let levels: Vec<_> = rows(page.table("levels")?).collect();
    blocks.push(Block::Table(clusters(settings, &levels, page)?));
    let mut missing = Vec::new();
    for picture in &PICTURES {
        let file = format!("{}.png", picture.stem);
        if page.folder.join(&file).exists() {
            let caption = picture.caption.into();
            blocks.push(Block::Figure(FigureLink { file, caption }));
        } else {
            missing.push(file);
        }
    }
    if !missing.is_empty() {
        let missing = missing.join(", ");
        let text = format!("Not there: {missing}. Running the experiment draws them.");
        blocks.push(Block::Text(text));
    }
    Ok(blocks)
}

fn voxelmaps<'f>(rows: impl Iterator<Item = Row<'f>>) -> Table {
    let mut table = Table::new(
        "Voxelmaps by encoding and store",
        &[
            "holds",
            "stored",
            "voxels",
            "values stored",
            "size, MB",
            "surface and inside, s",
            "distances, s",
            "error bound, mm: in the narrow band / beyond",
        ],
    );
    for row in rows {
        let case = row.text("case");
        let (holds, stored) = case.split_once('_').unwrap_or((&case, ""));
        let holds = match holds {
            "distances" => "distances, 16 bits",
            "floats" => "distances, 32-bit floats",
            "layers" => "layers, 16 bits",
            "descent" => "distances by gradient descent, 16 bits",
            other => other,
        };
        let number = |column: &str| row.number(column);
        let sides = ["voxels_x", "voxels_y", "voxels_z"].map(|side| fixed(number(side), 0));
        table.push([
            holds.into(),
            stored.into(),
            sides.join(" x "),
            fixed(number("values"), 0),
            significant(number("map_mb")),
            significant(number("voxels_s")),
            significant(number("distances_s")),
            format!(
                "{} / {}",
                significant(number("near_error_mm")),
                significant(number("far_error_mm"))
            ),
        ]);
    }
    table
}

/// The label of a clustering.
fn clustering(case: &str) -> &str {
    match case {
        "bisect" => "bisection, from the top",
        "bottom_up" => "bottom-up, the nearest K from the leaves (section 2.1.2)",
        other => other,
    }
}

fn pointshells<'f>(rows: impl Iterator<Item = Row<'f>>, page: &Page<'_>) -> Result<Table, Error> {
    let mut table = Table::new(
        "Pointshells by how points are put into clusters",
        &[
            "shell",
            "clusters",
            "points",
            "levels",
            "size, MB",
            "points, s",
            "tree, s",
            "whole asset, s",
            "whole file, MB",
        ],
    );
    for row in rows {
        let number = |column: &str| row.number(column);
        table.push([
            page.label(&row.text("algorithm"))?.into(),
            clustering(&row.text("case")).into(),
            fixed(number("points"), 0),
            fixed(number("levels"), 0),
            significant(number("tree_mb")),
            significant(number("points_s")),
            significant(number("tree_s")),
            significant(number("asset_build_s")),
            significant(number("file_mb")),
        ]);
    }
    Ok(table)
}

/// A row for each shell, a column for each level.
fn clusters(settings: &Settings, levels: &[Row<'_>], page: &Page<'_>) -> Result<Table, Error> {
    let numbers = levels.iter().filter_map(|row| row.number("level"));
    let deepest = numbers.fold(0.0, f64::max) as u32;
    let heads: Vec<_> = (1..=deepest).map(|level| format!("L = {level}")).collect();
    let mut head = vec!["shell", "clusters"];
    head.extend(heads.iter().map(String::as_str));
    let mut table = Table::new(
        "Clusters of each level, their children on average, mean radius of their spheres in mm",
        &head,
    );
    for name in &settings.shells {
        for case in SHELLS {
            let cell = |level: u32| {
                let row = levels.iter().find(|row| {
                    row.text("algorithm") == *name
                        && row.text("case") == case
                        && row.number("level") == Some(level.into())
                });
                row.map_or_else(String::new, |row| {
                    format!(
                        "{}; {}; {}",
                        fixed(row.number("clusters"), 0),
                        fixed(row.number("children_mean"), 1),
                        significant(row.number("radius_mm_mean"))
                    )
                })
            };
            let cells: Vec<_> = (1..=deepest).map(cell).collect();
            let label = page.label(name)?.to_owned();
            table.push(
                [label, clustering(case).to_owned()]
                    .into_iter()
                    .chain(cells),
            );
        }
    }
    Ok(table)
}
