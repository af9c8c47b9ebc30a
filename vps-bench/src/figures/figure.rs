//! Figures as SVG and PNG, without a display and without fonts of the system.

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Once;

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::register_font;

use crate::page::grouped;

/// A curve.
pub(crate) struct Curve {
    pub(crate) label: String,
    pub(crate) color: RGBColor,
    /// Runs of points; between two runs nothing is drawn.
    pub(crate) runs: Vec<Vec<(f64, f64)>>,
    /// Whether each point gets a dot.
    pub(crate) has_points: bool,
}

/// A value printed in the paper, as a dashed line.
pub(crate) struct Mark {
    pub(crate) color: RGBColor,
    pub(crate) x: Range<f64>,
    pub(crate) y: f64,
}

/// What is along a side of a figure.
pub(crate) struct Axis {
    label: String,
    range: Range<f64>,
    is_logarithmic: bool,
}

/// Curves over two axes.
pub(crate) struct Figure {
    pub(crate) title: String,
    pub(crate) x: Axis,
    pub(crate) y: Axis,
    pub(crate) curves: Vec<Curve>,
    pub(crate) marks: Vec<Mark>,
    /// What the dashed lines are, for the legend.
    pub(crate) marks_label: String,
}

impl Axis {
    pub(crate) fn linear(label: impl Into<String>, range: Range<f64>) -> Self {
        Self {
            label: label.into(),
            range,
            is_logarithmic: false,
        }
    }

    /// From one power of ten to another.
    pub(crate) fn logarithmic(label: impl Into<String>, range: Range<f64>) -> Self {
        Self {
            label: label.into(),
            range,
            is_logarithmic: true,
        }
    }

    /// Where a value is drawn.
    fn at(&self, value: f64) -> f64 {
        if self.is_logarithmic {
            value.log10()
        } else {
            value
        }
    }

    fn drawn(&self) -> Range<f64> {
        self.at(self.range.start)..self.at(self.range.end)
    }

    /// How many values are written along it: each power of ten.
    fn labels(&self) -> usize {
        if self.is_logarithmic {
            let drawn = self.drawn();
            (drawn.end - drawn.start).round() as usize + 1
        } else {
            11
        }
    }

    /// What is written at a place.
    fn text(&self, at: f64) -> String {
        if self.is_logarithmic {
            return plain(10_f64.powf(at.round()));
        }
        let span = self.range.end - self.range.start;
        let digits = (1.0 - (span / 10.0).log10()).floor().clamp(0.0, 6.0) as usize;
        let text = format!("{at:.digits$}");
        if digits == 0 {
            text
        } else {
            text.trim_end_matches('0').trim_end_matches('.').into()
        }
    }
}

/// Whole powers of ten around all values above zero, not below `least`.
pub(crate) fn decades(curves: &[Curve], others: &[f64], least: f64) -> Range<f64> {
    let points = curves.iter().flat_map(|c| c.runs.iter().flatten());
    let values = points.map(|p| p.1).chain(others.iter().copied());
    let (low, high) = values
        .filter(|y| *y > 0.0 && y.is_finite())
        .fold((f64::INFINITY, least), |(low, high), y| {
            (y.min(low), y.max(high))
        });
    let low = low.min(high).max(least);
    let (low, high) = (low.log10().floor(), high.log10().ceil());
    10_f64.powf(low)..10_f64.powf(high.max(low + 1.0))
}

#[derive(Debug, thiserror::Error)]
#[error("{}: {what}", path.display())]
pub(crate) struct FigureError {
    path: PathBuf,
    what: String,
}

const SIZE: (u32, u32) = (1100, 600);
pub(crate) const FONT: &str = "sans-serif";

/// Makes text drawable with the font that comes along.
pub(crate) fn register_fonts() {
    static FONT_REGISTERED: Once = Once::new();
    FONT_REGISTERED.call_once(|| {
        let font = epaint_default_fonts::UBUNTU_LIGHT;
        // The font is a constant of its crate, known to be one.
        let _ = register_font(FONT, FontStyle::Normal, font);
    });
}

impl Figure {
    /// Writes `stem.svg` and `stem.png`.
    pub(crate) fn write(&self, folder: &Path, stem: &str) -> Result<(), FigureError> {
        register_fonts();
        for extension in ["svg", "png"] {
            let path = folder.join(format!("{stem}.{extension}"));
            // Complete before it gets its name, so that no half figure is ever seen.
            let temporary = folder.join(format!("{stem}.tmp.{extension}"));
            let drawn = if extension == "svg" {
                self.draw(&SVGBackend::new(&temporary, SIZE).into_drawing_area())
            } else {
                self.draw(&BitMapBackend::new(&temporary, SIZE).into_drawing_area())
            };
            let renamed =
                drawn.and_then(|()| std::fs::rename(&temporary, &path).map_err(|e| e.to_string()));
            renamed.map_err(|what| FigureError { path, what })?;
        }
        Ok(())
    }

    fn draw<B: DrawingBackend>(&self, area: &DrawingArea<B, Shift>) -> Result<(), String> {
        let error = |e: DrawingAreaErrorKind<B::ErrorType>| e.to_string();
        area.fill(&WHITE).map_err(error)?;
        let at = |(x, y): (f64, f64)| (self.x.at(x), self.y.at(y));
        let mut chart = ChartBuilder::on(area)
            .caption(&self.title, (FONT, 24))
            .margin(12)
            // The last value of an axis is written around its end.
            .margin_right(44)
            .x_label_area_size(48)
            .y_label_area_size(112)
            .build_cartesian_2d(self.x.drawn(), self.y.drawn())
            .map_err(error)?;
        chart
            .configure_mesh()
            .x_desc(&self.x.label)
            .y_desc(&self.y.label)
            .x_labels(self.x.labels())
            .y_labels(self.y.labels())
            .axis_desc_style((FONT, 19))
            .label_style((FONT, 17))
            .x_label_formatter(&|x| self.x.text(*x))
            .y_label_formatter(&|y| self.y.text(*y))
            .light_line_style(RGBColor(242, 242, 242))
            .bold_line_style(RGBColor(222, 222, 222))
            .draw()
            .map_err(error)?;
        for curve in &self.curves {
            let color = curve.color;
            for (i, run) in curve.runs.iter().enumerate() {
                let points = || run.iter().copied().map(at);
                let line = LineSeries::new(points(), color.stroke_width(2));
                let drawn = chart.draw_series(line).map_err(error)?;
                if i == 0 {
                    drawn.label(&curve.label).legend(move |(x, y)| {
                        PathElement::new([(x, y), (x + 24, y)], color.stroke_width(3))
                    });
                }
                if curve.has_points {
                    let dots = points().map(|p| Circle::new(p, 4, color.filled()));
                    chart.draw_series(dots).map_err(error)?;
                }
            }
        }
        for (i, mark) in self.marks.iter().enumerate() {
            let ends = [(mark.x.start, mark.y), (mark.x.end, mark.y)].map(at);
            let line = DashedLineSeries::new(ends, 7, 5, mark.color.stroke_width(2));
            let drawn = chart.draw_series(line).map_err(error)?;
            if i == 0 {
                drawn.label(&self.marks_label).legend(|(x, y)| {
                    let dash = |from, to| {
                        PathElement::new([(x + from, y), (x + to, y)], BLACK.stroke_width(2))
                    };
                    EmptyElement::at((0, 0)) + dash(0, 7) + dash(12, 19)
                });
            }
        }
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::UpperLeft)
            .label_font((FONT, 17))
            .legend_area_size(32)
            .margin(8)
            .background_style(WHITE.mix(0.85))
            .border_style(RGBColor(200, 200, 200))
            .draw()
            .map_err(error)?;
        area.present().map_err(error)
    }
}

/// A power of ten without an exponent, its digits in groups of three.
fn plain(y: f64) -> String {
    let decimals = (-y.log10()).ceil().max(0.0) as usize;
    if decimals > 0 {
        return format!("{y:.decimals$}");
    }
    grouped(&format!("{y:.0}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_of_ten_are_written_out() {
        let written = [0.01, 0.1, 1.0, 100.0, 1e3, 1e6].map(plain);
        assert_eq!(written, ["0.01", "0.1", "1", "100", "1 000", "1 000 000"]);
    }

    /// Text is drawn with the font that comes along: nothing is taken from the system.
    #[test]
    fn figures_are_drawn_with_text() {
        let folder = std::env::temp_dir().join(format!("vps-figure-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let figure = |title: &str| Figure {
            title: title.into(),
            x: Axis::linear("step", 0.0..10.0),
            y: Axis::logarithmic("time", 1.0..1000.0),
            curves: vec![Curve {
                label: "a".into(),
                color: RGBColor(0, 114, 178),
                runs: vec![vec![(1.0, 3.0), (9.0, 300.0)]],
                has_points: true,
            }],
            marks: vec![Mark {
                color: RGBColor(0, 114, 178),
                x: 2.0..8.0,
                y: 50.0,
            }],
            marks_label: "b".into(),
        };
        figure("A title").write(&folder, "one").unwrap();
        figure("Another").write(&folder, "two").unwrap();
        let read = |name: &str| std::fs::read(folder.join(name)).unwrap();
        let svg = String::from_utf8(read("one.svg")).unwrap();
        assert!(svg.contains("A title") && svg.contains("polyline"));
        assert!(read("one.png").starts_with(b"\x89PNG"));
        assert!(read("one.png") != read("two.png"));
        assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 4);
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
