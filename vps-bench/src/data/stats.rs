//! Summary statistics, power laws and power spectra.

/// Sorted finite values; others are left out.
pub(crate) struct Sample(Vec<f64>);

impl Sample {
    pub(crate) fn of(values: impl IntoIterator<Item = f64>) -> Self {
        let mut values: Vec<_> = values.into_iter().filter(|v| v.is_finite()).collect();
        values.sort_by(f64::total_cmp);
        Self(values)
    }

    /// The number of values.
    pub(crate) fn count(&self) -> f64 {
        self.0.len() as f64
    }

    /// The quantile `q` from 0 to 1, interpolated between neighbours.
    pub(crate) fn quantile(&self, q: f64) -> Option<f64> {
        let last = self.0.len().checked_sub(1)?;
        let at = q.clamp(0.0, 1.0) * last as f64;
        let (low, high) = (self.0[at.floor() as usize], self.0[at.ceil() as usize]);
        Some(low + (high - low) * at.fract())
    }

    pub(crate) fn median(&self) -> Option<f64> {
        self.quantile(0.5)
    }

    pub(crate) fn min(&self) -> Option<f64> {
        self.quantile(0.0)
    }

    pub(crate) fn max(&self) -> Option<f64> {
        self.quantile(1.0)
    }

    pub(crate) fn mean(&self) -> Option<f64> {
        let is_empty = self.0.is_empty();
        (!is_empty).then(|| self.0.iter().sum::<f64>() / self.count())
    }

    /// The standard deviation.
    pub(crate) fn standard_deviation(&self) -> Option<f64> {
        let mean = self.mean()?;
        Self(self.0.iter().map(|v| v - mean).collect()).root_mean_square()
    }

    /// The root mean square.
    pub(crate) fn root_mean_square(&self) -> Option<f64> {
        let squares = Self(self.0.iter().map(|v| v * v).collect());
        squares.mean().map(f64::sqrt)
    }
}

/// The exponent p of the power law y = c x^p that fits points best: the slope of the least-squares
/// line through their logarithms. Points that are not positive are left out; `None` without two
/// different x.
pub(crate) fn power_law_exponent(points: impl IntoIterator<Item = (f64, f64)>) -> Option<f64> {
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

/// The power spectrum of equally spaced values without their mean: a one-sided periodogram with a
/// Hann window. Pairs of a frequency in Hz, from the lowest up to half the rate, and the spectral
/// density there, in squares of the values' unit per Hz.
///
/// The sums are evaluated by definition, in time quadratic in the number of values.
pub(crate) fn power_spectrum(values: &[f64], step_s: f64) -> Vec<(f64, f64)> {
    let count = values.len();
    let mean = values.iter().sum::<f64>() / count as f64;
    let turn = |part: usize| (std::f64::consts::TAU * part as f64 / count as f64).sin_cos();
    let turns: Vec<_> = (0..count).map(turn).collect();
    let window: Vec<_> = turns.iter().map(|(_, cos)| 0.5 * (1.0 - cos)).collect();
    let weights = window.iter().map(|w| w * w).sum::<f64>();
    let density = |wave: usize| {
        let (mut along, mut across) = (0.0, 0.0);
        for (k, (value, weight)) in values.iter().zip(&window).enumerate() {
            let (sin, cos) = turns[wave * k % count];
            along += weight * (value - mean) * cos;
            across += weight * (value - mean) * sin;
        }
        let frequency = wave as f64 / (count as f64 * step_s);
        (
            frequency,
            2.0 * (along * along + across * across) * step_s / weights,
        )
    };
    (1..=count / 2).map(density).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wave_has_its_power_at_its_frequency() {
        let (step_s, height) = (0.005, 3.0);
        let at = |k: i32| {
            let phase = std::f64::consts::TAU * 20.0 * step_s * f64::from(k);
            7.0 + height * (phase + 0.3).sin()
        };
        let spectrum = power_spectrum(&(0..400).map(at).collect::<Vec<_>>(), step_s);
        assert_eq!(spectrum.len(), 200);
        let per_hz = 0.5;
        let power = |near: fn(f64) -> bool| {
            let of_all = spectrum.iter().filter(|(hz, _)| near(*hz));
            of_all.map(|(_, density)| density * per_hz).sum::<f64>()
        };
        let all = 0.5 * height * height;
        assert!((power(|hz| (hz - 20.0).abs() < 1.1) / all - 1.0).abs() < 1e-9);
        assert!(power(|hz| (hz - 20.0).abs() > 1.1) / all < 1e-9);
    }

    #[test]
    fn a_power_law_has_its_exponent() {
        for power in [-2.0, -0.5, 0.0, 1.0, 3.0] {
            let law = |x: f64| (x, 7e-6 * x.powf(power));
            let found = power_law_exponent([1e-3, 2e-3, 0.5, 40.0].map(law)).unwrap();
            assert!((found - power).abs() < 1e-9, "{found} is not {power}");
        }
    }

    #[test]
    fn the_closest_line_is_that_of_least_squares() {
        let e = std::f64::consts::E;
        // Logarithms (0, 0), (1, 1), (2, 0), (3, 1): the slope is 1 / 5.
        let points = [(1.0, 1.0), (e, e), (e * e, 1.0), (e * e * e, e)];
        assert!((power_law_exponent(points).unwrap() - 0.2).abs() < 1e-12);
        // Points without a logarithm change nothing.
        let more = [
            (0.0, 1.0),
            (5.0, -1.0),
            (5.0, f64::NAN),
            (f64::INFINITY, 1.0),
        ];
        let found = power_law_exponent(points.into_iter().chain(more)).unwrap();
        assert!((found - 0.2).abs() < 1e-12);
    }

    #[test]
    fn one_place_has_no_slope() {
        assert_eq!(power_law_exponent([]), None);
        assert_eq!(power_law_exponent([(2.0, 3.0)]), None);
        assert_eq!(power_law_exponent([(2.0, 3.0), (2.0, 5.0)]), None);
    }

    #[test]
    fn samples_are_summarized() {
        let sample = Sample::of([4.0, f64::NAN, 1.0, 3.0, 2.0]);
        assert_eq!(sample.count(), 4.0);
        assert_eq!((sample.min(), sample.max()), (Some(1.0), Some(4.0)));
        assert_eq!((sample.median(), sample.mean()), (Some(2.5), Some(2.5)));
        assert_eq!(sample.standard_deviation(), Some(1.25_f64.sqrt()));
        assert_eq!(sample.root_mean_square(), Some(7.5_f64.sqrt()));
        let none = Sample::of([]);
        assert_eq!(
            (none.median(), none.mean(), none.standard_deviation()),
            (None, None, None)
        );
    }
}
