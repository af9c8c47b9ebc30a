//! The one place that depends on the processor.
#![allow(unsafe_code)]

/// Runs `work`, compiled for the widest registers of this processor that are known here.
///
/// What is inlined into `work` is compiled twice: for the processor the crate is built for, and for
/// x86-64 with AVX2 and its bit counting. Neither contracts nor reorders floating-point operations,
/// so both give the same bits; which one runs is chosen at run time with `std`, and by the
/// compiler's target without.
#[inline(always)]
pub(crate) fn dispatch<R>(work: impl FnOnce() -> R) -> R {
    #[cfg(all(feature = "std", target_arch = "x86_64", not(target_feature = "avx2")))]
    if has_avx2() {
        // SAFETY: the processor has what the function is compiled for.
        return unsafe { avx2(work) };
    }
    work()
}

#[cfg(all(feature = "std", target_arch = "x86_64", not(target_feature = "avx2")))]
#[inline(always)]
fn has_avx2() -> bool {
    extern crate std;
    use std::is_x86_feature_detected as has;
    has!("avx2") && has!("bmi1") && has!("bmi2") && has!("lzcnt") && has!("popcnt")
}

/// # Safety
/// The processor must have the named features.
#[cfg(all(feature = "std", target_arch = "x86_64", not(target_feature = "avx2")))]
#[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt")]
fn avx2<R>(work: impl FnOnce() -> R) -> R {
    work()
}
