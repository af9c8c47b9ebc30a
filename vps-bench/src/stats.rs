//! Numbers that sum up others.

/// Values in order; what is no number is left out.
pub(crate) struct Sample(Vec<f64>);

impl Sample {
    pub(crate) fn of(values: impl IntoIterator<Item = f64>) -> Self {
        let mut values: Vec<_> = values.into_iter().filter(|v| v.is_finite()).collect();
        values.sort_by(f64::total_cmp);
        Self(values)
    }

    /// How many there are.
    pub(crate) fn count(&self) -> f64 {
        self.0.len() as f64
    }

    /// The value below which a share `q` of all lies, interpolated between neighbours.
    pub(crate) fn quantile(&self, q: f64) -> Option<f64> {
        let last = self.0.len().checked_sub(1)?;
        let at = q.clamp(0.0, 1.0) * last as f64;
        let (low, high) = (self.0[at.floor() as usize], self.0[at.ceil() as usize]);
        Some(low + (high - low) * at.fract())
    }

    pub(crate) fn median(&self) -> Option<f64> {
        self.quantile(0.5)
    }

    pub(crate) fn least(&self) -> Option<f64> {
        self.quantile(0.0)
    }

    pub(crate) fn most(&self) -> Option<f64> {
        self.quantile(1.0)
    }

    pub(crate) fn mean(&self) -> Option<f64> {
        let is_empty = self.0.is_empty();
        (!is_empty).then(|| self.0.iter().sum::<f64>() / self.count())
    }

    /// The standard deviation: how far values are from their mean.
    pub(crate) fn deviation(&self) -> Option<f64> {
        let mean = self.mean()?;
        Self(self.0.iter().map(|v| v - mean).collect()).root_mean_square()
    }

    /// How far values are from zero.
    pub(crate) fn root_mean_square(&self) -> Option<f64> {
        let squares = Self(self.0.iter().map(|v| v * v).collect());
        squares.mean().map(f64::sqrt)
    }
}

/// The exponent p of the power law y = c x^p closest to the points: the slope of a straight line
/// through their logarithms, by least squares. Points that are not positive have no logarithm and
/// are left out; `None` without two different x.
pub(crate) fn exponent(points: impl IntoIterator<Item = (f64, f64)>) -> Option<f64> {
    let is_positive = |v: f64| v > 0.0 && v.is_finite();
    let positive = points
        .into_iter()
        .filter(|(x, y)| is_positive(*x) && is_positive(*y));
    let logarithms: Vec<_> = positive.map(|(x, y)| (x.ln(), y.ln())).collect();
    let count = logarithms.len() as f64;
    let mean_x = logarithms.iter().map(|p| p.0).sum::<f64>() / count;
    let mean_y = logarithms.iter().map(|p| p.1).sum::<f64>() / count;
    let along = |f: fn(f64, f64) -> f64| -> f64 {
        let from_mean = logarithms.iter().map(|(x, y)| (x - mean_x, y - mean_y));
        from_mean.map(|(x, y)| f(x, y)).sum()
    };
    let spread = along(|x, _| x * x);
    (spread > 1e-12).then(|| along(|x, y| x * y) / spread)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_power_law_has_its_exponent() {
        for power in [-2.0, -0.5, 0.0, 1.0, 3.0] {
            let law = |x: f64| (x, 7e-6 * x.powf(power));
            let found = exponent([1e-3, 2e-3, 0.5, 40.0].map(law)).unwrap();
            assert!((found - power).abs() < 1e-9, "{found} is not {power}");
        }
    }

    #[test]
    fn the_closest_line_is_that_of_least_squares() {
        let e = std::f64::consts::E;
        // Logarithms (0, 0), (1, 1), (2, 0), (3, 1): the slope is 1 / 5.
        let points = [(1.0, 1.0), (e, e), (e * e, 1.0), (e * e * e, e)];
        assert!((exponent(points).unwrap() - 0.2).abs() < 1e-12);
        // What has no logarithm changes nothing.
        let more = [
            (0.0, 1.0),
            (5.0, -1.0),
            (5.0, f64::NAN),
            (f64::INFINITY, 1.0),
        ];
        let found = exponent(points.into_iter().chain(more)).unwrap();
        assert!((found - 0.2).abs() < 1e-12);
    }

    #[test]
    fn one_place_has_no_slope() {
        assert_eq!(exponent([]), None);
        assert_eq!(exponent([(2.0, 3.0)]), None);
        assert_eq!(exponent([(2.0, 3.0), (2.0, 5.0)]), None);
    }

    #[test]
    fn values_are_summed_up() {
        let sample = Sample::of([4.0, f64::NAN, 1.0, 3.0, 2.0]);
        assert_eq!(sample.count(), 4.0);
        assert_eq!((sample.least(), sample.most()), (Some(1.0), Some(4.0)));
        assert_eq!((sample.median(), sample.mean()), (Some(2.5), Some(2.5)));
        assert_eq!(sample.deviation(), Some(1.25_f64.sqrt()));
        assert_eq!(sample.root_mean_square(), Some(7.5_f64.sqrt()));
        let none = Sample::of([]);
        assert_eq!(
            (none.median(), none.mean(), none.deviation()),
            (None, None, None)
        );
    }
}
