//! Warnings about worlds in which VPS shapes cannot collide as they should. Each is given once in a
//! process, by the `log` crate if the program logs warnings and on standard error otherwise.

use std::sync::atomic::{AtomicBool, Ordering};

pub(crate) const REMEDY: &str = "call `vps_rapier::set_up` with the size of the smallest body";

/// Prediction, relative to the diagonal of the smaller shape, above which contacts are found on sides
/// of a shape that do not face the other.
pub(crate) const MAX_PREDICTION: f32 = 0.5;

/// Motion in a step, relative to the prediction, below which the prediction does not come from the
/// speed of a body with soft CCD.
const MAX_MOTION: f32 = 0.1;

/// Whether a query has ever reached a dispatcher of ours.
static IS_CONNECTED: AtomicBool = AtomicBool::new(false);

/// Whether warnings are suppressed, during queries whose contacts are not used.
static IS_SUPPRESSED: AtomicBool = AtomicBool::new(false);

/// Whether the warning of a missing dispatcher was given.
static WARNED_OF_DISPATCHER: AtomicBool = AtomicBool::new(false);

/// Whether the warning of a large prediction was given.
static WARNED_OF_PREDICTION: AtomicBool = AtomicBool::new(false);

/// Calls `action` without any warning.
pub(crate) fn without_warnings<T>(action: impl FnOnce() -> T) -> T {
    IS_SUPPRESSED.store(true, Ordering::Relaxed);
    let result = action();
    IS_SUPPRESSED.store(false, Ordering::Relaxed);
    result
}

/// Called by our dispatcher in every query.
pub(crate) fn set_connected() {
    if !IS_CONNECTED.load(Ordering::Relaxed) {
        IS_CONNECTED.store(true, Ordering::Relaxed);
    }
}

/// Called by a VPS shape when parry's own dispatcher requests its faces. Our dispatcher prevents that,
/// so the likely reason is a world without it.
pub(crate) fn warn_if_disconnected() {
    if !IS_CONNECTED.load(Ordering::Relaxed) {
        warn(&WARNED_OF_DISPATCHER, || {
            "parry's own dispatcher got a query about a VPS shape, for which it finds no contacts"
                .into()
        });
    }
}

/// Called with the prediction of a pair, the diagonal of its smaller shape, and how far the two have
/// moved since the contacts before, all in metres.
pub(crate) fn warn_if_predicted_far(prediction: f32, size: f32, motion: f32) {
    if prediction > MAX_PREDICTION * size && motion < MAX_MOTION * prediction {
        warn(&WARNED_OF_PREDICTION, || {
            format!("contacts of a VPS shape of {size} m are predicted {prediction} m ahead")
        });
    }
}

fn warn(is_given: &AtomicBool, problem: impl FnOnce() -> String) {
    if IS_SUPPRESSED.load(Ordering::Relaxed) || is_given.swap(true, Ordering::Relaxed) {
        return;
    }
    let warning = problem();
    if log::log_enabled!(log::Level::Warn) {
        log::warn!("{warning}: {REMEDY}");
    } else {
        eprintln!("vps-rapier: {warning}: {REMEDY}");
    }
}
