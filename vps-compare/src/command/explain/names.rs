//! Names of outcomes and reasons, in tables and in JSON.

use vps_core::{DropReason, Fate};
use vps_rapier::{PairDropReason, TurnReason};

/// The outcome of a point that no search tested.
pub(super) const UNTESTED: &str = "untested";
/// The outcome of a point that was tested and is no contact.
pub(super) const NO_CONTACT: &str = "no_contact";
/// The outcome of a contact that lies where another one does.
pub(super) const MERGED: &str = "merged";
/// The outcome of a contact that remains.
pub(super) const KEPT: &str = "kept";

/// What reduction of the contacts of a shell does to one.
pub(super) fn of_fate(fate: Fate) -> &'static str {
    match fate {
        Fate::Kept { .. } => KEPT,
        Fate::Merged { .. } => MERGED,
        Fate::Dropped(reason) => of_reduction(reason),
    }
}

/// Why an engine does not get a contact.
pub(super) fn of_drop(reason: PairDropReason) -> &'static str {
    match reason {
        PairDropReason::Reduced(reason) => of_reduction(reason),
        PairDropReason::NormalLimit => "normal_limit",
        PairDropReason::PreviousPersist => "previous_persist",
        PairDropReason::PreviousReplaced => "previous_replaced",
        PairDropReason::Opposed => "opposed",
    }
}

/// Why a normal is turned.
pub(super) fn of_turn(reason: TurnReason) -> &'static str {
    match reason {
        TurnReason::Resolved => "resolved",
        TurnReason::DeepPenetration => "deep_penetration",
    }
}

/// What an outcome means, for people.
pub(super) fn meaning(outcome: &str) -> &'static str {
    match outcome {
        UNTESTED => "below pruned clusters, and no contact",
        NO_CONTACT => "tested, and too far outside to be a contact",
        MERGED => "where another contact lies, or refined to the same deepest point",
        KEPT => "kept",
        "low_weight" => "less than half of the weight of the deepest contact: too far outside",
        "no_area" => "within the polygon of the selected contacts",
        "planar" => "would add area, but the field is planar, where four contacts are enough",
        "full" => "would add less area than those selected, and the manifold is full",
        "normal_limit" => "four contacts with the same normal come before it",
        "opposed" => "pushes against the total push, deep inside",
        _ => "",
    }
}

fn of_reduction(reason: DropReason) -> &'static str {
    match reason {
        DropReason::LowWeight => "low_weight",
        DropReason::NoArea => "no_area",
        DropReason::Planar => "planar",
        DropReason::Full => "full",
    }
}
