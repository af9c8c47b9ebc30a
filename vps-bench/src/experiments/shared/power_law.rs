//! Figures of power laws: both axes logarithmic, so that y = c x^p is a line of slope p.

use plotters::style::RGBColor;

use crate::data::number_format::fixed;
use crate::data::stats::power_law_exponent;
use crate::error::Error;
use crate::figures::axis::Axis;
use crate::figures::figure::{Curve, Figure, decades};
use crate::report::document::Block;
use crate::report::page::Page;

/// Values by size.
pub(crate) struct Series {
    pub(crate) label: String,
    pub(crate) color: RGBColor,
    pub(crate) points: Vec<(f64, f64)>,
}

/// File name, title and axis labels of a figure.
pub(crate) struct Labels<'l> {
    /// File name without extension.
    pub(crate) stem: &'l str,
    pub(crate) title: &'l str,
    pub(crate) x: &'l str,
    pub(crate) y: &'l str,
}

/// Colours that can be told apart with colour blindness (Okabe and Ito).
pub(crate) fn color(number: usize) -> RGBColor {
    const COLORS: [RGBColor; 7] = [
        RGBColor(0, 114, 178),
        RGBColor(213, 94, 0),
        RGBColor(0, 158, 115),
        RGBColor(204, 121, 167),
        RGBColor(230, 159, 0),
        RGBColor(86, 180, 233),
        RGBColor(0, 0, 0),
    ];
    COLORS[number % COLORS.len()]
}

/// Writes a figure with the exponent of each series in its label. Values that are not positive are
/// left out.
pub(crate) fn figure(
    labels: &Labels<'_>,
    series: impl IntoIterator<Item = Series>,
    page: &Page<'_>,
) -> Result<Block, Error> {
    let is_positive = |v: &f64| *v > 0.0 && v.is_finite();
    let mut curves = Vec::new();
    for one in series {
        let slope = power_law_exponent(one.points.iter().copied());
        let points = one.points.into_iter();
        let run: Vec<_> = points
            .filter(|(x, y)| is_positive(x) && is_positive(y))
            .collect();
        if !run.is_empty() {
            curves.push(Curve {
                label: format!("{} (slope {})", one.label, fixed(slope, 2)),
                color: one.color,
                polylines: vec![run],
                has_markers: true,
            });
        }
    }
    if curves.is_empty() {
        return Ok(Block::Text(format!("{}: no values.", labels.title)));
    }
    let ends = |at: fn(&(f64, f64)) -> f64| {
        let values: Vec<_> = curves
            .iter()
            .flat_map(|c| &c.polylines[0])
            .map(at)
            .collect();
        decades(&[], &values, 1e-9)
    };
    let (x, y) = (ends(|p| p.0), ends(|p| p.1));
    // Space for the legend above the curves.
    let room = 10_f64.powf((0.4 * curves.len() as f64).ceil());
    let drawn = Figure {
        title: labels.title.into(),
        x: Axis::logarithmic(labels.x, x),
        y: Axis::logarithmic(labels.y, y.start..y.end * room),
        curves,
        reference_lines: Vec::new(),
        reference_label: String::new(),
    };
    page.figure(labels.stem, &drawn)
}
