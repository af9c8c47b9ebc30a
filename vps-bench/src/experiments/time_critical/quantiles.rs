//! Quantiles of many values.

/// Median, 99th percentile and largest of some values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Quantiles {
    pub(super) median: f64,
    pub(super) p99: f64,
    pub(super) max: f64,
}

impl Quantiles {
    /// Those of values that are numbers; `None` of none. A share q of all values is not above the
    /// quantile.
    pub(super) fn of(mut values: Vec<f64>) -> Option<Self> {
        values.sort_unstable_by(f64::total_cmp);
        let at = |share: f64| {
            let rank = (share * values.len() as f64).ceil() as usize;
            values.get(rank.saturating_sub(1)).copied()
        };
        Some(Self {
            median: at(0.5)?,
            p99: at(0.99)?,
            max: at(1.0)?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_share_of_all_values_is_not_above() {
        let quantiles = Quantiles::of((1..=200).rev().map(f64::from).collect()).unwrap();
        let expected = Quantiles {
            median: 100.0,
            p99: 198.0,
            max: 200.0,
        };
        assert_eq!(quantiles, expected);
        assert_eq!(Quantiles::of(vec![7.0]).unwrap().p99, 7.0);
        assert_eq!(Quantiles::of(Vec::new()), None);
    }
}
