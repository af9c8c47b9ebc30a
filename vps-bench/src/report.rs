//! Tables, figures and prose, made from records alone.

use std::fmt::Write;
use std::path::Path;

use polars::prelude::DataFrame;
use vps_build::write_atomically;

use crate::config::{Algorithm, Experiment};
use crate::figures::{Curve, Figure, Mark, color};
use crate::run::Records;
use crate::summary::{StepMedian, SummaryRow, course, frame, summarize};

type Error = Box<dyn std::error::Error>;

/// What ratios refer to.
const REFERENCE: &str = "vps_fine";

/// Writes `summary.csv`, the figures and `report.md` beside the records; gives the table.
pub(crate) fn report(folder: &Path, records: &Records) -> Result<String, Error> {
    let experiment = &records.environment.experiment;
    let steps = frame(&records.steps)?;
    let summary = summarize(experiment, &steps)?;
    crate::records::write(&folder.join("summary.csv"), &summary)?;
    let table = table(&summary);
    draw(folder, experiment, &steps)?;
    let text = prose(records, &table);
    write_atomically(&folder.join("report.md"), text.as_bytes())?;
    Ok(table)
}

/// Times of all algorithms as a Markdown table, with the paper's beside them.
fn table(summary: &[SummaryRow]) -> String {
    let mut table = String::from(
        "| algorithm | mean µs | median | p99 | max | against VPS fine | paper: mean µs | paper: \
         against VPS fine | contacts | deepest, mm: reported / true |\n\
         |---|---|---|---|---|---|---|---|---|---|\n",
    );
    let reference = summary.iter().find(|row| row.algorithm == REFERENCE);
    let ratio = |value: Option<f64>, of: Option<f64>| match (value, of) {
        (Some(value), Some(of)) => format!("{} x", short(value / of)),
        _ => "–".into(),
    };
    for row in summary {
        let of_ours = ratio(Some(row.query_us_mean), reference.map(|r| r.query_us_mean));
        let of_paper = ratio(row.paper_query_us, reference.and_then(|r| r.paper_query_us));
        let _ = writeln!(
            table,
            "| {} | {} | {} | {} | {} | {of_ours} | {} | {of_paper} | {:.1} | {:.2} / {:.2} |",
            row.label,
            short(row.query_us_mean),
            short(row.query_us_median),
            short(row.query_us_p99),
            short(row.query_us_max),
            row.paper_query_us.map_or_else(|| "–".into(), short),
            row.contacts_mean,
            row.penetration_mm_max,
            row.true_penetration_mm_max,
        );
    }
    table
}

/// Three significant digits.
fn short(value: f64) -> String {
    if !value.is_finite() {
        return "–".into();
    }
    let magnitude = value.abs().max(1e-12).log10().floor() as i32;
    let digits = (2 - magnitude).max(0) as usize;
    format!("{value:.digits$}")
}

fn prose(records: &Records, table: &str) -> String {
    let environment = &records.environment;
    let experiment = &environment.experiment;
    let [from, to] = experiment.runs.measured_steps;
    let orientations = records
        .jobs
        .iter()
        .map(|j| j.orientation + 1)
        .max()
        .unwrap_or(0);
    let mut text = format!(
        "# {}\n\nAfter the paper's {}.\n\n{}\n",
        experiment.title,
        experiment.paper,
        experiment.about.trim(),
    );
    let _ = write!(
        text,
        "\n## Collision query, steps {from} to {to}, {orientations} start orientations\n\n{table}\n\
         ![Time of the collision query by step](query_time.png)\n\n\
         ![Linear velocity by step](linear_velocity.png)\n\n\
         ## What the algorithms made of the mesh\n\n\
         | algorithm | size | preparation, s | of it building assets, s | asset files, MiB | \
         status |\n|---|---|---|---|---|---|\n",
    );
    for row in &records.preparations {
        let mib = row.asset_bytes as f64 / f64::from(1 << 20);
        let _ = writeln!(
            text,
            "| {} | {} | {:.2} | {} | {} | {} |",
            row.algorithm,
            row.size,
            row.prepare_s,
            row.asset_build_s
                .map_or_else(|| "–".into(), |s| format!("{s:.2}")),
            if row.asset_bytes == 0 {
                "–".into()
            } else {
                format!("{mib:.1}")
            },
            row.status,
        );
    }
    text.push_str("\nAssets built by an earlier run were only read.\n");
    let failures = records.failures();
    if !failures.is_empty() {
        text.push_str("\n## What failed\n\n");
    }
    for failure in failures {
        let _ = writeln!(text, "* {failure}");
    }
    text.push_str("\n## The paper's values\n\n");
    for value in &experiment.paper_value {
        let _ = writeln!(
            text,
            "* `{}`: {} µs ({})",
            value.algorithm,
            short(value.query_us),
            value.source
        );
    }
    let _ = write!(
        text,
        "\n## Environment\n\n\
         {}, {} logical cores, {} MiB, {} (kernel {}); {}, profile {}; rapier3d {}, parry3d {}; \
         revision {}. Taking a time costs {} ns, which every time contains. Records: `steps.csv`, \
         `jobs.csv`, `preparations.csv`, `environment.json`; summary: `summary.csv`.\n",
        environment.processor,
        environment.logical_cores,
        environment.memory_mib,
        environment.system,
        environment.kernel,
        environment.rustc,
        environment.profile,
        environment.rapier3d,
        environment.parry3d,
        if environment.revision.is_empty() {
            "unknown"
        } else {
            &environment.revision
        },
        environment.timer_overhead_ns,
    );
    text
}

fn draw(folder: &Path, experiment: &Experiment, steps: &DataFrame) -> Result<(), Error> {
    let mut courses = Vec::new();
    for (i, algorithm) in experiment.algorithm.iter().enumerate() {
        let course = course(steps, &algorithm.name)?;
        courses.push((algorithm, color(i), course));
    }
    let last_step = f64::from(experiment.world.steps);
    let curves = |value: fn(&StepMedian) -> Option<f64>| {
        let curve = |(algorithm, color, course): &(&Algorithm, _, Vec<StepMedian>)| Curve {
            label: algorithm.label.clone(),
            color: *color,
            runs: runs(course, value),
        };
        courses.iter().map(curve).collect::<Vec<_>>()
    };
    let [from, to] = experiment.runs.measured_steps.map(f64::from);
    let marks: Vec<_> = courses
        .iter()
        .filter_map(|(algorithm, color, _)| {
            let value = experiment.paper_value(&algorithm.name)?;
            Some(Mark {
                color: *color,
                x: from..to,
                y: value.query_us,
            })
        })
        .collect();
    let times = curves(|m| m.query_us);
    let y = decades(&times, marks.iter().map(|m| m.y), 0.01);
    let time = Figure {
        title: "Time of the collision query, median of all start orientations".into(),
        x_label: "step".into(),
        y_label: "time (µs)".into(),
        x: 0.0..last_step,
        // Room for the legend above the curves.
        y: y.start..y.end * 1000.0,
        curves: times,
        marks,
        marks_label: "mean in the paper (same colours)".into(),
    };
    time.write(folder, "query_time")?;
    let velocities = curves(|m| (m.linear_velocity_m_s > 1e-5).then_some(m.linear_velocity_m_s));
    let y = decades(&velocities, std::iter::empty(), 1e-5);
    let velocity = Figure {
        title: "Linear velocity, median of all start orientations".into(),
        x_label: "step".into(),
        y_label: "velocity (m/s)".into(),
        x: 0.0..last_step,
        y: y.start..y.end * 100.0,
        curves: velocities,
        marks: Vec::new(),
        marks_label: String::new(),
    };
    velocity.write(folder, "linear_velocity")?;
    Ok(())
}

/// The points that have a value, divided where one is missing.
fn runs(course: &[StepMedian], value: fn(&StepMedian) -> Option<f64>) -> Vec<Vec<(f64, f64)>> {
    course
        .chunk_by(|a, b| value(a).is_some() == value(b).is_some())
        .map(|run| {
            let points = run
                .iter()
                .filter_map(|m| Some((f64::from(m.step), value(m)?)));
            points.collect::<Vec<_>>()
        })
        .filter(|run| !run.is_empty())
        .collect()
}

/// Whole powers of ten around all values, not below `least`.
fn decades(
    curves: &[Curve],
    others: impl Iterator<Item = f64>,
    least: f64,
) -> std::ops::Range<f64> {
    let on_curves = curves
        .iter()
        .flat_map(|c| c.runs.iter().flatten())
        .map(|p| p.1);
    let (low, high) = on_curves
        .chain(others)
        .fold((f64::INFINITY, least), |(low, high), y| {
            (y.min(low), y.max(high))
        });
    let low = low.min(high).max(least);
    10_f64.powf(low.log10().floor())..10_f64.powf(high.log10().ceil())
}

/// Replaces what stands in a file between the marks `<!-- name -->` and `<!-- /name -->`.
pub(crate) fn splice(path: &Path, name: &str, content: &str) -> Result<(), Error> {
    let text = std::fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))?;
    let (open, close) = (format!("<!-- {name} -->"), format!("<!-- /{name} -->"));
    let (before, rest) = text
        .split_once(&open)
        .ok_or_else(|| format!("{}: the mark {open} is missing", path.display()))?;
    let (_, after) = rest
        .split_once(&close)
        .ok_or_else(|| format!("{}: the mark {close} is missing", path.display()))?;
    let text = format!("{before}{open}\n\n{content}\n{close}{after}");
    Ok(write_atomically(path, text.as_bytes())?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_three_digits() {
        let cases = [
            (97_270.4, "97270"),
            (710.0, "710"),
            (2.094, "2.09"),
            (0.12345, "0.123"),
        ];
        for (value, expected) in cases {
            assert_eq!(short(value), expected);
        }
        assert_eq!(short(f64::NAN), "–");
    }

    #[test]
    fn curves_break_where_there_was_no_query() {
        let at = |step, query_us| StepMedian {
            step,
            query_us,
            linear_velocity_m_s: 1.0,
        };
        let course = [
            at(0, None),
            at(1, Some(2.0)),
            at(2, Some(3.0)),
            at(3, None),
            at(4, Some(1.0)),
        ];
        let expected = [vec![(1.0, 2.0), (2.0, 3.0)], vec![(4.0, 1.0)]];
        assert_eq!(runs(&course, |m| m.query_us), expected);
    }
}
