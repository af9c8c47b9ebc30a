//! Presents the tables of falling bodies.

use polars::prelude::DataFrame;

use super::{Settings, Show};
use crate::data::dataframe::{Row, rows_of};
use crate::data::number_format::{fixed, significant};
use crate::error::Error;
use crate::figures::axis::Axis;
use crate::figures::figure::{Curve, Figure, ReferenceLine, decades};
use crate::report::document::{Block, Table};
use crate::report::page::Page;

pub(super) fn present(settings: &Settings, page: &Page<'_>) -> Result<Vec<Block>, Error> {
    let presentation = Presentation {
        settings,
        summary: page.table("summary")?,
        course: page.table("course")?,
        page,
    };
    let mut blocks = Vec::new();
    for show in &settings.show {
        match show {
            Show::QueryTimes => {
                blocks.push(presentation.query_times()?);
                blocks.push(presentation.times_by_step()?);
            }
            Show::LinearVelocity => blocks.push(presentation.by_step(
                "linear_velocity",
                "Linear velocity",
                ("linear_velocity_m_s", "velocity (m/s)"),
                1e-5,
            )?),
            Show::KineticEnergy => blocks.push(presentation.by_step(
                "kinetic_energy",
                "Kinetic energy",
                ("kinetic_energy_mj", "kinetic energy (mJ)"),
                1e-5,
            )?),
            Show::Spin => {
                blocks.push(presentation.spin(page.table("turning")?)?);
                blocks.push(presentation.spectrum(page.table("spectrum")?)?);
            }
            Show::Frequencies => {
                blocks.push(presentation.falls_through()?);
                blocks.push(presentation.penetrations()?);
            }
        }
    }
    Ok(blocks)
}

struct Presentation<'p> {
    settings: &'p Settings,
    summary: &'p DataFrame,
    course: &'p DataFrame,
    page: &'p Page<'p>,
}

impl Presentation<'_> {
    /// The row of an algorithm in a case.
    fn of(&self, case: &str, algorithm: &str) -> Option<Row<'_>> {
        rows_of(self.summary, case, algorithm).next()
    }

    /// The case of the curves.
    fn first_case(&self) -> String {
        Settings::case(self.settings.frequencies_hz[0])
    }

    /// Times of all algorithms in the first case, beside those of the paper.
    fn query_times(&self) -> Result<Block, Error> {
        let case = self.first_case();
        let frequency = self.settings.frequencies_hz[0];
        let [from, to] = self.settings.measured_steps(frequency);
        let against = match &self.settings.reference {
            Some(name) => format!("against {}", self.page.label(name)?),
            None => "against the first".into(),
        };
        let mut table = Table::new(
            format!("Collision query, steps {from} to {to}"),
            &[
                "algorithm",
                "mean µs",
                "median",
                "p99",
                "max",
                &against,
                "paper: mean µs",
                &format!("paper: {against}"),
                "contacts",
                "deepest, mm: reported / true",
            ],
        );
        let reference = self.settings.reference.as_ref();
        let reference = reference.unwrap_or(&self.settings.algorithms[0]);
        let mean = |name: &str| self.of(&case, name)?.number("query_us_mean");
        let printed = |name: &str| Some(self.settings.paper_value(name)?.query_us);
        let ratio = |value: Option<f64>, of: Option<f64>| match (value, of) {
            (Some(value), Some(of)) => format!("{} x", significant(value / of)),
            _ => "–".into(),
        };
        for name in &self.settings.algorithms {
            let Some(row) = self.of(&case, name) else {
                continue;
            };
            let number = |column: &str| row.number(column);
            table.push([
                self.page.label(name)?.into(),
                significant(number("query_us_mean")),
                significant(number("query_us_median")),
                significant(number("query_us_p99")),
                significant(number("query_us_max")),
                ratio(mean(name), mean(reference)),
                significant(printed(name)),
                ratio(printed(name), printed(reference)),
                fixed(number("contacts_mean"), 1),
                format!(
                    "{} / {}",
                    fixed(number("penetration_mm_max"), 2),
                    fixed(number("true_penetration_mm_max"), 2)
                ),
            ]);
        }
        Ok(Block::Table(table))
    }

    /// The values of a column over the steps of the first case, with gaps where values are missing.
    fn curves(&self, column: &str, least: f64) -> Result<Vec<Curve>, Error> {
        let case = self.first_case();
        let mut curves = Vec::new();
        for name in &self.settings.algorithms {
            let points: Vec<_> = rows_of(self.course, &case, name)
                .map(|row| {
                    let value = row.number(column).filter(|v| *v > least);
                    (row.number("step").unwrap_or_default(), value)
                })
                .collect();
            let runs = points.chunk_by(|a, b| a.1.is_some() == b.1.is_some());
            let runs = runs.map(|run| run.iter().filter_map(|(x, y)| Some((*x, (*y)?))).collect());
            let algorithm = self.page.algorithms.get(name)?;
            curves.push(Curve {
                label: algorithm.label.clone(),
                color: algorithm.rgb(),
                polylines: runs.filter(|run: &Vec<_>| !run.is_empty()).collect(),
                has_markers: false,
            });
        }
        Ok(curves)
    }

    fn steps_axis(&self) -> Axis {
        let steps = self.settings.steps(self.settings.frequencies_hz[0]);
        Axis::linear("step", 0.0..f64::from(steps))
    }

    fn times_by_step(&self) -> Result<Block, Error> {
        let curves = self.curves("query_us", 0.0)?;
        let [from, to] = self
            .settings
            .measured_steps(self.settings.frequencies_hz[0]);
        let mut reference_lines = Vec::new();
        for value in &self.settings.paper_value {
            reference_lines.push(ReferenceLine {
                color: self.page.algorithms.get(&value.algorithm)?.rgb(),
                x: f64::from(from)..f64::from(to),
                y: value.query_us,
            });
        }
        let printed: Vec<_> = reference_lines.iter().map(|m| m.y).collect();
        let y = decades(&curves, &printed, 0.01);
        let figure = Figure {
            title: "Time of the collision query, median of all start orientations".into(),
            x: self.steps_axis(),
            // Space for the legend above the curves.
            y: Axis::logarithmic("time (µs)", y.start..y.end * 1000.0),
            curves,
            reference_label: "mean in the paper (same colours)".into(),
            reference_lines,
        };
        self.page.figure("query_time", &figure)
    }

    fn by_step(
        &self,
        stem: &str,
        what: &str,
        (column, label): (&str, &str),
        least: f64,
    ) -> Result<Block, Error> {
        let curves = self.curves(column, least)?;
        let y = decades(&curves, &[], least);
        let figure = Figure {
            title: format!("{what}, median of all start orientations"),
            x: self.steps_axis(),
            y: Axis::logarithmic(label, y.start..y.end * 100.0),
            curves,
            reference_lines: Vec::new(),
            reference_label: String::new(),
        };
        self.page.figure(stem, &figure)
    }

    /// How evenly bodies roll: "discrete transitions" are changes of spin far above the median.
    fn spin(&self, turning: &DataFrame) -> Result<Block, Error> {
        let case = self.first_case();
        let mut table = Table::new(
            "Change of the angular velocity in a step, while the body rolls, and how fast it changes",
            &[
                "algorithm",
                "rolling steps",
                "median, rad/s",
                "p99, rad/s",
                "p99 / median",
                "power above 20 Hz, rad²/s²",
                "of all, %",
            ],
        );
        for name in &self.settings.algorithms {
            let Some(row) = self.of(&case, name) else {
                continue;
            };
            let median = row.number("spin_change_rad_s_median");
            let p99 = row.number("spin_change_rad_s_p99");
            let jump = median.zip(p99).map(|(median, p99)| p99 / median);
            let turning = rows_of(turning, &case, name).next();
            let power = |column: &str| turning.as_ref()?.number(column);
            let fast = power("power_above_20_hz_rad2_s2");
            let share = fast
                .zip(power("power_rad2_s2"))
                .map(|(fast, all)| 100.0 * fast / all);
            table.push([
                self.page.label(name)?.into(),
                fixed(row.number("rolling_steps"), 0),
                significant(median),
                significant(p99),
                significant(jump),
                significant(fast),
                significant(share),
            ]);
        }
        Ok(Block::Table(table))
    }

    /// The power spectrum of the angular velocity: a body that jumps has more power at high
    /// frequencies.
    fn spectrum(&self, spectrum: &DataFrame) -> Result<Block, Error> {
        let case = self.first_case();
        let mut curves = Vec::new();
        for name in &self.settings.algorithms {
            let algorithm = self.page.algorithms.get(name)?;
            let points = rows_of(spectrum, &case, name).filter_map(|row| {
                let power = row.number("power_rad2_s2_per_hz")?;
                Some((row.number("turning_hz")?, power))
            });
            let run: Vec<_> = points
                .filter(|(hz, power)| *hz >= 1.0 && *power > 0.0)
                .collect();
            curves.push(Curve {
                label: algorithm.label.clone(),
                color: algorithm.rgb(),
                polylines: vec![run],
                has_markers: false,
            });
        }
        let y = decades(&curves, &[], 1e-12);
        let figure = Figure {
            title: "Power of the angular velocity, mean of all start orientations".into(),
            x: Axis::logarithmic("frequency (Hz)", 1.0..100.0),
            // Space for the legend beside the curves.
            y: Axis::logarithmic("power (rad²/s² per Hz)", y.start..y.end * 1000.0),
            curves,
            reference_lines: Vec::new(),
            reference_label: String::new(),
        };
        self.page.figure("spin_spectrum", &figure)
    }

    /// A row for each algorithm, a column for each frequency.
    fn by_frequency(
        &self,
        caption: &str,
        cell: impl Fn(&Row<'_>) -> String,
    ) -> Result<Block, Error> {
        let frequencies = self.settings.frequencies_hz.iter();
        let cases = frequencies.map(|&f| (format!("{f} Hz"), Settings::case(f)));
        let cases: Vec<_> = cases.collect();
        self.page
            .by_case(caption, &self.settings.algorithms, &cases, cell)
    }

    fn falls_through(&self) -> Result<Block, Error> {
        self.by_frequency(
            "Bodies that fell through the ground, of all started",
            |row| {
                format!(
                    "{} of {}",
                    fixed(row.number("fell_through"), 0),
                    fixed(row.number("runs"), 0)
                )
            },
        )
    }

    fn penetrations(&self) -> Result<Block, Error> {
        self.by_frequency("True penetration at its deepest, mm", |row| {
            fixed(row.number("true_penetration_mm_max"), 1)
        })
    }
}
