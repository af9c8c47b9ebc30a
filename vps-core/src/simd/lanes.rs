//! The number of lanes, loads of incomplete groups, and masks.

use wide::f32x4;

/// How many points or discs a [`DistanceField`](crate::DistanceField) is asked for at a time.
pub const LANES: usize = 4;

/// Calls `read` with the first [`LANES`] of `all`, which must not be empty. If there are fewer, the
/// last one is repeated.
#[inline(always)]
pub(crate) fn padded<T: Copy, R>(all: &[T], read: impl FnOnce(&[T; LANES]) -> R) -> R {
    // By reference and in one place: copied, or read in two places, it takes twice the time.
    let copy;
    read(match all.first_chunk() {
        Some(first) => first,
        None => {
            copy = repeat_last(all);
            &copy
        }
    })
}

#[cold]
fn repeat_last<T: Copy>(all: &[T]) -> [T; LANES] {
    let mut first = [all[all.len() - 1]; LANES];
    first[..all.len()].copy_from_slice(all);
    first
}

/// The first `count` lanes as a mask.
#[inline(always)]
pub(crate) fn first_lanes(count: u32) -> f32x4 {
    f32x4::new([0.0, 1.0, 2.0, 3.0]).simd_lt(f32x4::splat(count as f32))
}

/// The lanes set in a mask, in ascending order.
#[inline(always)]
pub(crate) fn lanes_in(mask: f32x4) -> impl Iterator<Item = usize> {
    let mut lanes = mask.to_bitmask();
    core::iter::from_fn(
        #[inline(always)]
        move || {
            if lanes == 0 {
                return None;
            }
            let lane = lanes.trailing_zeros() as usize % LANES;
            lanes &= lanes - 1;
            Some(lane)
        },
    )
}
