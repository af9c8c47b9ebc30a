//! Random orientations.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use vps_core::Quat;

/// A uniformly distributed orientation, determined by seed and number.
pub(crate) fn random_orientation(seed: u64, number: u32) -> Quat {
    let mut rng = ChaCha8Rng::seed_from_u64(seed.wrapping_add(u64::from(number)));
    orientation_of(rng.random())
}

/// The orientation of three uniform numbers between 0 and 1 (Shoemake, 1992).
pub(crate) fn orientation_of([u, v, w]: [f32; 3]) -> Quat {
    let (v, w) = (v * std::f32::consts::TAU, w * std::f32::consts::TAU);
    let (a, b) = ((1.0 - u).sqrt(), u.sqrt());
    Quat::from_xyzw(a * v.sin(), a * v.cos(), b * w.sin(), b * w.cos()).normalize()
}
