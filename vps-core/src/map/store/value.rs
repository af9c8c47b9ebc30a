//! The values of a store, and loads of neighbouring pairs.

use bytemuck::Pod;
use wide::{f32x4, i32x4};

use crate::simd::LANES;
use crate::storage::Storage;

/// The values of a [`Store`](crate::raw::Store).
#[derive(Clone, Debug)]
pub enum Values<'a> {
    /// 16-bit integers: layers, or distances in steps of λ (eq. 1).
    Integers(Storage<'a, i16>),
    /// 32-bit floating-point distances in metres.
    Floats(Storage<'a, f32>),
}

impl Values<'_> {
    /// The number of values.
    pub fn len(&self) -> usize {
        match self {
            Self::Integers(values) => values.len(),
            Self::Floats(values) => values.len(),
        }
    }

    /// Whether there is no value.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The values as bytes in native byte order.
    pub fn bytes(&self) -> &[u8] {
        match self {
            Self::Integers(values) => bytemuck::cast_slice(values),
            Self::Floats(values) => bytemuck::cast_slice(values),
        }
    }

    #[cfg(feature = "alloc")]
    pub(super) fn into_owned(self) -> Values<'static> {
        match self {
            Self::Integers(values) => Values::Integers(values.into_owned()),
            Self::Floats(values) => Values::Floats(values.into_owned()),
        }
    }
}

/// A value as it is stored.
pub(super) trait StoredValue: Pod + Into<f32> {
    /// Two neighbouring values along x.
    type Pair: Pod;

    fn pair(values: &[Self], first: usize) -> Self::Pair;

    fn pair_of(first: Self, second: Self) -> Self::Pair;

    /// The first values of all pairs, and the second ones.
    fn unzip(pairs: [Self::Pair; LANES]) -> [f32x4; 2];
}

impl StoredValue for i16 {
    /// Both in one word, as they lie in memory.
    type Pair = i32;

    #[inline(always)]
    fn pair(values: &[Self], first: usize) -> i32 {
        // One load: the compiler generates slower code for two.
        let mut pair = [0_i16; 2];
        pair.copy_from_slice(&values[first..first + 2]);
        bytemuck::cast(pair)
    }

    #[inline(always)]
    fn pair_of(first: Self, second: Self) -> i32 {
        i32::from(second) << 16 | i32::from(first) & 0xffff
    }

    #[inline(always)]
    fn unzip([a, b, c, d]: [i32; LANES]) -> [f32x4; 2] {
        let both = i32x4::new([a, b, c, d]);
        let low: i32x4 = (both << 16) >> 16;
        let high: i32x4 = both >> 16;
        [low.round_float(), high.round_float()]
    }
}

impl StoredValue for f32 {
    type Pair = [f32; 2];

    #[inline(always)]
    fn pair(values: &[Self], first: usize) -> [f32; 2] {
        let pair = &values[first..first + 2];
        [pair[0], pair[1]]
    }

    #[inline(always)]
    fn pair_of(first: f32, second: f32) -> [f32; 2] {
        [first, second]
    }

    #[inline(always)]
    fn unzip([a, b, c, d]: [[f32; 2]; LANES]) -> [f32x4; 2] {
        [
            f32x4::new([a[0], b[0], c[0], d[0]]),
            f32x4::new([a[1], b[1], c[1], d[1]]),
        ]
    }
}
