//! Whether queries about the VPS shapes of this process reach our dispatcher.

use std::sync::atomic::{AtomicBool, Ordering};

pub(crate) const REMEDY: &str = "make the world with `narrow_phase: vps_rapier::narrow_phase()`";

/// Whether a dispatcher of ours was ever asked.
static IS_CONNECTED: AtomicBool = AtomicBool::new(false);

/// Whether the warning was given.
static IS_WARNED: AtomicBool = AtomicBool::new(false);

/// Whether the warning is suppressed, while pairs are asked whose contacts are not used.
static IS_SUPPRESSED: AtomicBool = AtomicBool::new(false);

/// Calls `action` without the warning of [`warn_if_disconnected`].
pub(crate) fn without_warning<T>(action: impl FnOnce() -> T) -> T {
    IS_SUPPRESSED.store(true, Ordering::Relaxed);
    let result = action();
    IS_SUPPRESSED.store(false, Ordering::Relaxed);
    result
}

/// Called by our dispatcher whenever it is asked.
pub(crate) fn set_connected() {
    if !IS_CONNECTED.load(Ordering::Relaxed) {
        IS_CONNECTED.store(true, Ordering::Relaxed);
    }
}

/// Called by a VPS shape that parry's own dispatcher asks for its faces. Our dispatcher prevents that,
/// so the likely reason is a world without it. Warns once in a process, by the `log` crate if the
/// program logs warnings and on standard error otherwise.
pub(crate) fn warn_if_disconnected() {
    if IS_CONNECTED.load(Ordering::Relaxed)
        || IS_SUPPRESSED.load(Ordering::Relaxed)
        || IS_WARNED.swap(true, Ordering::Relaxed)
    {
        return;
    }
    let warning = "parry's own dispatcher was asked for contacts of a VPS shape and has none";
    if log::log_enabled!(log::Level::Warn) {
        log::warn!("{warning}: {REMEDY}");
    } else {
        eprintln!("vps-rapier: {warning}: {REMEDY}");
    }
}
