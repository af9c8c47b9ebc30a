//! Quantisation of penetrations to the values of a store (eq. 1).

use rayon::prelude::*;
use vps_core::raw::Values;

/// How a penetration becomes a stored value.
#[derive(Clone, Copy)]
pub(crate) enum Quantizer {
    /// Integers of this many metres, truncated towards zero (eq. 1).
    Integers(f64),
    /// Layers of this many metres, rounded: they are whole up to floating-point rounding.
    Layers(f64),
    Floats,
}

impl Quantizer {
    /// The stored value of a penetration.
    pub(crate) fn quantize(self, penetration: f64) -> f32 {
        match self {
            Self::Integers(sigma) => (penetration / sigma) as i16 as f32,
            Self::Layers(size) => (penetration / size).round() as i16 as f32,
            Self::Floats => penetration as f32,
        }
    }

    /// Metres per unit of a stored value.
    pub(crate) fn sigma(self) -> f64 {
        match self {
            Self::Integers(sigma) | Self::Layers(sigma) => sigma,
            Self::Floats => 1.0,
        }
    }

    pub(crate) fn values(self, values: Vec<f32>) -> Values<'static> {
        match self {
            Self::Integers(_) | Self::Layers(_) => {
                Values::Integers(values.iter().map(|&v| v as i16).collect::<Vec<_>>().into())
            }
            Self::Floats => Values::Floats(values.into()),
        }
    }

    /// The values of all voxels, for a dense store.
    pub(crate) fn quantize_all(self, penetrations: &[f32]) -> Values<'static> {
        let values = penetrations.par_iter();
        self.values(values.map(|&p| self.quantize(f64::from(p))).collect())
    }
}
