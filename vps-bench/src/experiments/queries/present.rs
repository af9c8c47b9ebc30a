//! Presents the tables of queries.

use super::poses::PoseSet;
use super::query_kind::QueryKind;
use super::{Case, Settings};
use crate::data::dataframe::{Row, rows, rows_of};
use crate::data::number_format::{fixed, significant};
use crate::error::Error;
use crate::experiments::shared::power_law::{Labels, Series, color, figure};
use crate::report::document::{Block, Table};
use crate::report::page::Page;

pub(super) fn present(settings: &Settings, page: &Page<'_>) -> Result<Vec<Block>, Error> {
    let mut blocks = vec![
        Block::Table(manifolds(settings, page)?),
        Block::Table(interlocked(settings, page)?),
    ];
    for set in PoseSet::ALL {
        blocks.push(Block::Table(fields(set, page)?));
    }
    blocks.push(Block::Table(clusterings(page)?));
    let by_points = Labels {
        stem: "points",
        title: "Time of a query by points of the shell",
        x: "points",
        y: "time (µs)",
    };
    let by_triangles = Labels {
        stem: "triangles",
        title: "Time of a query by triangles of the source mesh, a torus in a torus",
        x: "triangles",
        y: "time (µs)",
    };
    let of_points = &QueryKind::BY_POINTS[..];
    blocks.extend(sizes(Case::Points, of_points, &by_points, page)?);
    let of_triangles = &QueryKind::BY_TRIANGLES[..];
    blocks.extend(sizes(Case::Triangles, of_triangles, &by_triangles, page)?);
    Ok(blocks)
}

/// The ratio of two times in words.
fn ratio(time: Option<f64>, by: Option<f64>) -> String {
    significant(time.zip(by).map(|(time, by)| time / by))
}

fn manifolds(settings: &Settings, page: &Page<'_>) -> Result<Table, Error> {
    let times = page.table("manifolds")?;
    let mut head = vec!["algorithm".to_owned(), "median, µs".to_owned()];
    for name in &settings.against {
        head.push(format!("{} / this", page.label(name)?));
    }
    let head: Vec<_> = head.iter().map(String::as_str).collect();
    let ahead_mm = fixed(f64::from(settings.fall.prediction_m) * 1e3, 0);
    let caption = format!("Contact manifolds as an engine asks for them, {ahead_mm} mm ahead");
    let mut table = Table::new(caption, &head);
    let median = |name: &str| {
        let row = rows_of(times, Case::Manifolds.name(), name).next();
        row.and_then(|row| row.number("query_us_median"))
    };
    for name in &settings.algorithms {
        let own = median(name);
        let ratios = settings
            .against
            .iter()
            .map(|other| ratio(median(other), own));
        let first = [page.label(name)?.to_owned(), significant(own)];
        table.push(first.into_iter().chain(ratios));
    }
    Ok(table)
}

fn interlocked(settings: &Settings, page: &Page<'_>) -> Result<Table, Error> {
    let times = page.table("manifolds")?;
    let median = |name: &str| {
        let row = rows_of(times, Case::Interlocked.name(), name).next();
        row.and_then(|row| row.number("query_us_median"))
    };
    let trimesh = median(&settings.trimesh);
    let mut table = Table::new(
        "The body in itself, interlocked",
        &["algorithm", "median, µs", "triangle mesh / this"],
    );
    for name in [&settings.shell, &settings.trimesh] {
        let own = median(name);
        table.push([
            page.label(name)?.to_owned(),
            significant(own),
            ratio(trimesh, own),
        ]);
    }
    Ok(table)
}

/// The label of the query in a row.
fn label(row: &Row<'_>) -> String {
    let name = row.text("query");
    let mut kinds = QueryKind::ALL.into_iter().chain(QueryKind::BY_POINTS);
    let kind = kinds.find(|kind| kind.name() == name);
    kind.map_or(name, |kind| kind.label())
}

fn fields(set: PoseSet, page: &Page<'_>) -> Result<Table, Error> {
    let mut table = Table::new(
        format!("Queries, {}", set.label()),
        &[
            "query",
            "cuboid, µs",
            "dense voxelmap, µs",
            "sparse voxelmap, µs",
            "sparse / dense",
            "spheres tested",
            "points tested",
        ],
    );
    for row in rows(page.table("fields")?).filter(|row| row.text("case") == set.name()) {
        table.push([
            label(&row),
            significant(row.number("cuboid_us")),
            significant(row.number("dense_us")),
            significant(row.number("sparse_us")),
            fixed(row.number("sparse_by_dense"), 2),
            fixed(row.number("spheres"), 0),
            fixed(row.number("points"), 0),
        ]);
    }
    Ok(table)
}

fn clusterings(page: &Page<'_>) -> Result<Table, Error> {
    let mut table = Table::new(
        "Spheres and points tested on the dense voxelmap of the ground, contacts predicted, by clustering",
        &[
            "query",
            "spheres, bisection",
            "spheres, bottom-up",
            "points, bisection",
            "points, bottom-up",
        ],
    );
    for row in rows(page.table("clusterings")?) {
        let columns = [
            "bisect_spheres",
            "bottom_up_spheres",
            "bisect_points",
            "bottom_up_points",
        ];
        let numbers = columns.map(|column| fixed(row.number(column), 0));
        table.push([label(&row)].into_iter().chain(numbers));
    }
    Ok(table)
}

/// A figure of times by size, their table, and how they grow.
fn sizes(
    case: Case,
    kinds: &[QueryKind],
    labels: &Labels<'_>,
    page: &Page<'_>,
) -> Result<[Block; 3], Error> {
    let (sizes, growth) = (page.table("sizes")?, page.table("growth")?);
    let of_case = |row: &Row<'_>| row.text("case") == case.name();
    let series = kinds.iter().enumerate().map(|(i, kind)| {
        let of_kind = rows(sizes).filter(of_case);
        let of_kind = of_kind.filter(|row| row.text("query") == kind.name());
        let points = of_kind.filter_map(|row| row.number("size").zip(row.number("query_us")));
        Series {
            label: kind.label(),
            color: color(i),
            points: points.collect(),
        }
    });
    let drawn = figure(labels, series, page)?;
    let head = ["query", labels.x, "µs", "contacts", "ns a contact"];
    let mut times = Table::new(labels.title, &head);
    for row in rows(sizes).filter(of_case) {
        let (time, contacts) = (row.number("query_us"), row.number("contacts"));
        let each = time.zip(contacts.filter(|n| *n >= 1.0));
        times.push([
            label(&row),
            fixed(row.number("size"), 0),
            significant(time),
            fixed(contacts, 0),
            significant(each.map(|(time, contacts)| 1e3 * time / contacts)),
        ]);
    }
    let mut growths = Table::new(
        format!("How time grows with the {}", labels.x),
        &["query", "power", "longest / shortest"],
    );
    for row in rows(growth).filter(of_case) {
        growths.push([
            label(&row),
            fixed(row.number("power"), 2),
            fixed(row.number("largest_ratio"), 2),
        ]);
    }
    Ok([drawn, Block::Table(times), Block::Table(growths)])
}
