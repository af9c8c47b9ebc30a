//! Figures of curves, as SVG and PNG.

use std::ops::Range;
use std::path::{Path, PathBuf};

use plotters::coord::Shift;
use plotters::prelude::*;

use crate::figures::axis::Axis;
use crate::figures::font::{FONT, register_fonts};

/// A curve.
pub(crate) struct Curve {
    pub(crate) label: String,
    pub(crate) color: RGBColor,
    /// Polylines; there is a gap between two of them.
    pub(crate) polylines: Vec<Vec<(f64, f64)>>,
    /// Whether each point gets a marker.
    pub(crate) has_markers: bool,
}

/// A dashed horizontal line, such as a value printed in the paper.
pub(crate) struct ReferenceLine {
    pub(crate) color: RGBColor,
    pub(crate) x: Range<f64>,
    pub(crate) y: f64,
}

/// Curves over two axes.
pub(crate) struct Figure {
    pub(crate) title: String,
    pub(crate) x: Axis,
    pub(crate) y: Axis,
    pub(crate) curves: Vec<Curve>,
    pub(crate) reference_lines: Vec<ReferenceLine>,
    /// The label of the reference lines in the legend.
    pub(crate) reference_label: String,
}

/// The range of powers of ten that encloses all positive values, not below `least`.
pub(crate) fn decades(curves: &[Curve], others: &[f64], least: f64) -> Range<f64> {
    let points = curves.iter().flat_map(|c| c.polylines.iter().flatten());
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

/// Why a figure cannot be written.
#[derive(Debug, thiserror::Error)]
#[error("{}: {message}", path.display())]
pub(crate) struct FigureError {
    path: PathBuf,
    message: String,
}

/// Width and height in pixels.
const SIZE: (u32, u32) = (1100, 600);

impl Figure {
    /// Writes `stem.svg` and `stem.png`.
    pub(crate) fn write(&self, folder: &Path, stem: &str) -> Result<(), FigureError> {
        register_fonts();
        for extension in ["svg", "png"] {
            let path = folder.join(format!("{stem}.{extension}"));
            // Renamed when complete, so that no partial file is ever seen.
            let temporary = folder.join(format!("{stem}.tmp.{extension}"));
            let drawn = if extension == "svg" {
                self.draw(&SVGBackend::new(&temporary, SIZE).into_drawing_area())
            } else {
                self.draw(&BitMapBackend::new(&temporary, SIZE).into_drawing_area())
            };
            let renamed =
                drawn.and_then(|()| std::fs::rename(&temporary, &path).map_err(|e| e.to_string()));
            renamed.map_err(|message| FigureError { path, message })?;
        }
        Ok(())
    }

    fn draw<B: DrawingBackend>(&self, area: &DrawingArea<B, Shift>) -> Result<(), String> {
        let error = |e: DrawingAreaErrorKind<B::ErrorType>| e.to_string();
        area.fill(&WHITE).map_err(error)?;
        let at = |(x, y): (f64, f64)| (self.x.coordinate(x), self.y.coordinate(y));
        let mut chart = ChartBuilder::on(area)
            .caption(&self.title, (FONT, 24))
            .margin(12)
            // The last label of an axis is centred at its end.
            .margin_right(44)
            .x_label_area_size(48)
            .y_label_area_size(112)
            .build_cartesian_2d(self.x.drawn_range(), self.y.drawn_range())
            .map_err(error)?;
        chart
            .configure_mesh()
            .x_desc(&self.x.label)
            .y_desc(&self.y.label)
            .x_labels(self.x.label_count())
            .y_labels(self.y.label_count())
            .axis_desc_style((FONT, 19))
            .label_style((FONT, 17))
            .x_label_formatter(&|x| self.x.tick_text(*x))
            .y_label_formatter(&|y| self.y.tick_text(*y))
            .light_line_style(RGBColor(242, 242, 242))
            .bold_line_style(RGBColor(222, 222, 222))
            .draw()
            .map_err(error)?;
        for curve in &self.curves {
            let color = curve.color;
            for (i, run) in curve.polylines.iter().enumerate() {
                let points = || run.iter().copied().map(at);
                let line = LineSeries::new(points(), color.stroke_width(2));
                let drawn = chart.draw_series(line).map_err(error)?;
                if i == 0 {
                    drawn.label(&curve.label).legend(move |(x, y)| {
                        PathElement::new([(x, y), (x + 24, y)], color.stroke_width(3))
                    });
                }
                if curve.has_markers {
                    let dots = points().map(|p| Circle::new(p, 4, color.filled()));
                    chart.draw_series(dots).map_err(error)?;
                }
            }
        }
        for (i, mark) in self.reference_lines.iter().enumerate() {
            let ends = [(mark.x.start, mark.y), (mark.x.end, mark.y)].map(at);
            let line = DashedLineSeries::new(ends, 7, 5, mark.color.stroke_width(2));
            let drawn = chart.draw_series(line).map_err(error)?;
            if i == 0 {
                drawn.label(&self.reference_label).legend(|(x, y)| {
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Text is drawn with the bundled font; nothing is taken from the system.
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
                polylines: vec![vec![(1.0, 3.0), (9.0, 300.0)]],
                has_markers: true,
            }],
            reference_lines: vec![ReferenceLine {
                color: RGBColor(0, 114, 178),
                x: 2.0..8.0,
                y: 50.0,
            }],
            reference_label: "b".into(),
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
