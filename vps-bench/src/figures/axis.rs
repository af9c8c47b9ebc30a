//! Axes of figures, linear or logarithmic.

use std::ops::Range;

use crate::data::number_format::group_digits;

/// An axis of a figure: its label, range and scale.
pub(crate) struct Axis {
    pub(super) label: String,
    range: Range<f64>,
    is_logarithmic: bool,
}

impl Axis {
    /// Linear.
    pub(crate) fn linear(label: impl Into<String>, range: Range<f64>) -> Self {
        Self {
            label: label.into(),
            range,
            is_logarithmic: false,
        }
    }

    /// Logarithmic, from one power of ten to another.
    pub(crate) fn logarithmic(label: impl Into<String>, range: Range<f64>) -> Self {
        Self {
            label: label.into(),
            range,
            is_logarithmic: true,
        }
    }

    /// The coordinate at which a value is drawn.
    pub(super) fn coordinate(&self, value: f64) -> f64 {
        if self.is_logarithmic {
            value.log10()
        } else {
            value
        }
    }

    /// The range of coordinates.
    pub(super) fn drawn_range(&self) -> Range<f64> {
        self.coordinate(self.range.start)..self.coordinate(self.range.end)
    }

    /// The number of labels: one for each power of ten if logarithmic.
    pub(super) fn label_count(&self) -> usize {
        if self.is_logarithmic {
            let drawn = self.drawn_range();
            (drawn.end - drawn.start).round() as usize + 1
        } else {
            11
        }
    }

    /// The label at a coordinate.
    pub(super) fn tick_text(&self, at: f64) -> String {
        if self.is_logarithmic {
            return decimal(10_f64.powf(at.round()));
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

/// A power of ten without an exponent, its digits in groups of three.
fn decimal(y: f64) -> String {
    let decimals = (-y.log10()).ceil().max(0.0) as usize;
    if decimals > 0 {
        return format!("{y:.decimals$}");
    }
    group_digits(&format!("{y:.0}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_of_ten_are_written_out() {
        let written = [0.01, 0.1, 1.0, 100.0, 1e3, 1e6].map(decimal);
        assert_eq!(written, ["0.01", "0.1", "1", "100", "1 000", "1 000 000"]);
    }
}
