//! Presents the tables of the haptic loop.

use polars::prelude::DataFrame;

use crate::data::dataframe::{Row, rows};
use crate::data::number_format::{fixed, significant};
use crate::error::Error;
use crate::experiments::shared::power_law::color;
use crate::figures::axis::Axis;
use crate::figures::figure::{Curve, Figure, decades};
use crate::report::document::{Block, Table};
use crate::report::page::Page;

pub(super) fn present(page: &Page<'_>) -> Result<Vec<Block>, Error> {
    let course = page.table("course")?;
    let mut blocks = vec![
        deadlines(page.table("deadlines")?),
        collision(page.table("collision")?),
        figure(
            page,
            course,
            &Curves {
                stem: "collision_time",
                title: "Time of the collision part, asked again: the longest in each 10 ms",
                column: "replayed_us_max",
                label: "time (µs)",
                is_logarithmic: true,
                stores: &["dense", "sparse"],
            },
        )?,
        felt(page.table("felt")?),
        figure(
            page,
            course,
            &Curves {
                stem: "force",
                title: "Force of the device: the largest in each 10 ms, dense voxelmaps",
                column: "force_n_max",
                label: "force (N)",
                is_logarithmic: false,
                stores: &["dense"],
            },
        )?,
    ];
    for row in rows(page.table("stores")?) {
        blocks.push(Block::Text(format!(
            "Forces on the {} with the sparse voxelmap differ from those with the dense one by {} N at \
             most.",
            row.text("scene"),
            fixed(row.number("force_difference_n_max"), 3)
        )));
    }
    Ok(blocks)
}

fn deadlines(deadlines: &DataFrame) -> Block {
    let mut table = Table::new(
        "Deadlines: a cycle is missed if it ends later than the next is due",
        &[
            "scene",
            "voxelmap",
            "cycles",
            "missed",
            "latest end, µs",
            "begun late, µs: 99.9 %",
            "most",
            "longest cycle, µs",
            "longer than 1 ms",
        ],
    );
    for row in rows(deadlines) {
        let whole = |column: &str| fixed(row.number(column), 0);
        table.push([
            row.text("scene"),
            row.text("store"),
            whole("cycles"),
            whole("missed"),
            whole("end_us_max"),
            fixed(row.number("late_us_p999"), 1),
            whole("late_us_max"),
            whole("cycle_us_max"),
            whole("long"),
        ]);
    }
    Block::Table(table)
}

fn collision(collision: &DataFrame) -> Block {
    let mut table = Table::new(
        "The collision part in µs, in the loop and asked again afterwards: median / 99.9 % / most",
        &[
            "scene",
            "voxelmap",
            "in the loop",
            "asked again",
            "without stiffness, asked again: median",
            "contacts, most",
        ],
    );
    for row in rows(collision) {
        let quantiles = |what: &str| {
            let columns = ["median", "p999", "max"].map(|q| format!("{what}_{q}"));
            columns.map(|c| significant(row.number(&c))).join(" / ")
        };
        table.push([
            row.text("scene"),
            row.text("store"),
            quantiles("collision_us"),
            quantiles("replayed_us"),
            significant(row.number("wrench_us_median")),
            fixed(row.number("contacts_max"), 0),
        ]);
    }
    Block::Table(table)
}

fn felt(felt: &DataFrame) -> Block {
    let mut table = Table::new(
        "What is felt, second by second, with dense voxelmaps: the largest of each; the jump is the \
         change of the force from one cycle to the next",
        &[
            "scene",
            "from, s",
            "force, N",
            "jump, N",
            "torque, N m",
            "depth of the tool, mm",
            "contacts",
        ],
    );
    for row in rows(felt).filter(|row| row.text("store") == "dense") {
        let number = |column: &str, digits| fixed(row.number(column), digits);
        table.push([
            row.text("scene"),
            number("time_s", 0),
            number("force_n_max", 2),
            number("jump_n_max", 2),
            number("torque_n_m_max", 3),
            number("penetration_mm_max", 3),
            number("contacts_max", 0),
        ]);
    }
    Block::Table(table)
}

/// A figure of a column of the course, a curve for each scene and store.
struct Curves<'c> {
    stem: &'c str,
    title: &'c str,
    column: &'c str,
    /// Label of the y axis.
    label: &'c str,
    is_logarithmic: bool,
    stores: &'c [&'c str],
}

fn figure(page: &Page<'_>, course: &DataFrame, what: &Curves<'_>) -> Result<Block, Error> {
    let all: Vec<_> = rows(course)
        .filter(|row| what.stores.contains(&row.text("store").as_str()))
        .collect();
    let same = |a: &Row<'_>, b: &Row<'_>| {
        ["scene", "store"]
            .iter()
            .all(|column| a.text(column) == b.text(column))
    };
    let mut curves = Vec::new();
    for (number, run) in all.chunk_by(same).enumerate() {
        let point = |row: &Row<'_>| {
            let value = row.number(what.column)?;
            let is_drawn = value > 0.0 || !what.is_logarithmic;
            is_drawn.then_some((row.number("time_s")?, value))
        };
        curves.push(Curve {
            label: format!("{}, {}", run[0].text("scene"), run[0].text("store")),
            color: color(number),
            polylines: vec![run.iter().filter_map(point).collect()],
            has_markers: false,
        });
    }
    let points = || curves.iter().flat_map(|c| &c.polylines[0]);
    let seconds = points().map(|p| p.0).fold(0.0, f64::max).ceil();
    let y = if what.is_logarithmic {
        let y = decades(&curves, &[], 0.1);
        // Space for the legend above the curves.
        Axis::logarithmic(what.label, y.start..y.end * 100.0)
    } else {
        let highest = points().map(|p| p.1).fold(1.0, f64::max);
        Axis::linear(what.label, 0.0..1.3 * highest)
    };
    let figure = Figure {
        title: what.title.into(),
        x: Axis::linear("time (s)", 0.0..seconds.max(1.0)),
        y,
        curves,
        reference_lines: Vec::new(),
        reference_label: String::new(),
    };
    page.figure(what.stem, &figure)
}
