//! Presents the tables of bouncing balls.

use plotters::style::RGBColor;
use polars::prelude::DataFrame;

use super::{Case, Settings};
use crate::data::dataframe::{Row, rows_of};
use crate::data::number_format::fixed;
use crate::error::Error;
use crate::figures::axis::Axis;
use crate::figures::figure::{Curve, Figure, ReferenceLine};
use crate::report::document::{Block, Table};
use crate::report::page::Page;

pub(super) fn present(settings: &Settings, page: &Page<'_>) -> Result<Vec<Block>, Error> {
    let presentation = Presentation {
        settings,
        summary: page.table("summary")?,
        course: page.table("course")?,
        page,
    };
    let mut blocks = vec![
        presentation.penetrations()?,
        presentation.apexes()?,
        presentation.drifts()?,
    ];
    for case in settings.drawn_cases() {
        blocks.push(presentation.heights(case)?);
    }
    Ok(blocks)
}

struct Presentation<'p> {
    settings: &'p Settings,
    summary: &'p DataFrame,
    course: &'p DataFrame,
    page: &'p Page<'p>,
}

/// Colour of the exact solution and its rebound height.
const EXACT: RGBColor = RGBColor(0, 0, 0);

impl Presentation<'_> {
    fn of(&self, case: Case, algorithm: &str) -> Option<Row<'_>> {
        let case = case.name();
        rows_of(self.summary, &case, algorithm).next()
    }

    /// A row for each case; a column for each algorithm, behind the `first` columns.
    fn by_case(
        &self,
        caption: String,
        first: &[&str],
        start: impl Fn(Case) -> Vec<String>,
        cell: impl Fn(Case, &Row<'_>) -> String,
    ) -> Result<Block, Error> {
        let mut head: Vec<_> = first.iter().map(|h| (*h).to_owned()).collect();
        for name in &self.settings.algorithms {
            head.push(self.page.label(name)?.into());
        }
        let head: Vec<_> = head.iter().map(String::as_str).collect();
        let mut table = Table::new(caption, &head);
        for case in self.settings.cases() {
            let cells = self.settings.algorithms.iter().map(|name| {
                let row = self.of(case, name);
                row.map_or_else(|| "–".into(), |row| cell(case, &row))
            });
            let cells: Vec<_> = cells.collect();
            table.push(start(case).into_iter().chain(cells));
        }
        Ok(Block::Table(table))
    }

    /// Table 1.
    fn penetrations(&self) -> Result<Block, Error> {
        let printed = |case: Case, algorithm: &str| {
            let mut values = self.settings.paper_value.iter();
            let found =
                values.find(|v| v.algorithm == algorithm && v.restitution == case.restitution);
            found.map_or(String::new(), |v| {
                format!(" (paper {})", fixed(v.penetration_mm, 1))
            })
        };
        self.by_case(
            "Deepest penetration in mm: true, median and worst of all start orientations / \
             reported to the engine, worst"
                .into(),
            &["contacts ahead", "c"],
            case_cells,
            |case, row| {
                let number = |column: &str| fixed(row.number(column), 1);
                format!(
                    "{}, {} / {}{}",
                    number("true_penetration_mm_median"),
                    number("true_penetration_mm_max"),
                    number("penetration_mm_max"),
                    printed(case, &row.text("algorithm"))
                )
            },
        )
    }

    fn apexes(&self) -> Result<Block, Error> {
        self.by_case(
            "Height of the centre at its highest after the first bounce, in m: median of all \
             start orientations"
                .into(),
            &["contacts ahead", "c", "exact"],
            |case| {
                let exact = self.settings.exact(case.restitution);
                let mut cells = case_cells(case);
                cells.push(fixed(exact.first_apex_m(), 3));
                cells
            },
            |_, row| fixed(row.number("apex_m_median"), 3),
        )
    }

    fn drifts(&self) -> Result<Block, Error> {
        self.by_case(
            "How far the centre moved sideways, which an exact ball does not, in mm: median of all \
             start orientations"
                .into(),
            &["contacts ahead", "c"],
            case_cells,
            |_, row| fixed(row.number("aside_mm_median"), 0),
        )
    }

    /// Fig. 6, for one coefficient of restitution.
    fn heights(&self, case: Case) -> Result<Block, Error> {
        let settings = self.settings;
        let exact = settings.exact(case.restitution);
        let mut curves = vec![Curve {
            label: "exact".into(),
            color: EXACT,
            polylines: vec![
                (0..settings.steps())
                    .map(|step| f64::from(step) / f64::from(settings.frequency_hz))
                    .map(|time| (time, exact.height_m(time)))
                    .collect(),
            ],
            has_markers: false,
        }];
        let name = case.name();
        for algorithm in &settings.algorithms {
            let course = rows_of(self.course, &name, algorithm);
            let points = course.filter_map(|r| r.number("time_s").zip(r.number("height_m")));
            let of_list = self.page.algorithms.get(algorithm)?;
            curves.push(Curve {
                label: of_list.label.clone(),
                color: of_list.rgb(),
                polylines: vec![points.collect()],
                has_markers: false,
            });
        }
        let title = format!(
            "Height of the centre, c = {}, contacts found {} mm ahead",
            case.restitution,
            fixed(case.prediction_m * 1e3, 0)
        );
        let fall = settings.drop_height_m - settings.radius_m;
        let figure = Figure {
            title,
            x: Axis::linear("time (s)", 0.0..settings.duration_s),
            // Space for the legend above the curves.
            y: Axis::linear(
                "height (m)",
                settings.radius_m - 0.1 * fall..settings.drop_height_m + 0.6 * fall,
            ),
            curves,
            reference_lines: vec![ReferenceLine {
                color: EXACT,
                x: 0.0..settings.duration_s,
                y: exact.first_apex_m(),
            }],
            reference_label: "exact height after the first bounce".into(),
        };
        self.page.figure(&format!("height_{name}"), &figure)
    }
}

fn case_cells(case: Case) -> Vec<String> {
    vec![
        format!("{} mm", fixed(case.prediction_m * 1e3, 0)),
        format!("{}", case.restitution),
    ]
}
