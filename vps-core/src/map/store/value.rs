//! The numbers in a store, and pairs of them.

use bytemuck::Pod;
use wide::{f32x4, i32x4};

use crate::simd::LANES;
use crate::storage::Storage;

/// The numbers in a [`Store`](crate::Store).
#[derive(Clone, Debug)]
pub enum Values<'a> {
    /// 16-bit integers: layers, or distances in steps of λ (eq. 1).
    Integers(Storage<'a, i16>),
    /// 32-bit floating-point distances in metres.
    Floats(Storage<'a, f32>),
}

impl Values<'_> {
    /// How many there are.
    pub fn len(&self) -> usize {
        match self {
            Self::Integers(values) => values.len(),
            Self::Floats(values) => values.len(),
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The values as bytes in the machine's order.
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

/// A number in a store.
pub(super) trait Value: Pod + Into<f32> {
    /// Two that lie next to each other.
    type Pair: Pod;

    fn pair(values: &[Self], first: usize) -> Self::Pair;

    fn pair_of(first: Self, second: Self) -> Self::Pair;

    /// The first ones of all pairs, and the second ones.
    fn unzip(pairs: [Self::Pair; LANES]) -> [f32x4; 2];
}

impl Value for i16 {
    /// Both at once, as they lie in memory.
    type Pair = i32;

    #[inline(always)]
    fn pair(values: &[Self], first: usize) -> i32 {
        // As a whole: of two loads the compiler makes worse.
        let mut pair = [0_i16; 2];
        pair.copy_from_slice(&values[first..first + 2]);
        let both: i32 = bytemuck::cast(pair);
        if cfg!(target_endian = "big") {
            both.rotate_left(16)
        } else {
            both
        }
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

impl Value for f32 {
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
