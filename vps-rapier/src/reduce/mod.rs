//! Contact reduction: from all contacts of a pair to the few an engine gets, in one pipeline.
//!
//! For [`Manifolds::Reduced`] the steps of [`contacts`] are:
//! 1. Each shell gives the deepest contact and those that spread over the largest area, each sampled
//!    edge its contact.
//! 2. Contacts refined to the same deepest point are merged ([`merge`]).
//! 3. Contacts of several sources are reduced together ([`select`]).
//! 4. Normals on which field and shell disagree are resolved ([`normals`]).
//! 5. At most four contacts of each normal are kept ([`select`]).
//! 6. The contacts of the step before stay if they are as good ([`persistence`]).
//! 7. Deep inside, contacts that push against each other are turned to one direction
//!    ([`deep_penetration`]).
//!
//! All constants of the pipeline are in [`parameters`]. Each step tells an observer what becomes of
//! contacts ([`event`](crate::query::event)).

mod deep_penetration;
mod merge;
mod normals;
mod parameters;
pub(crate) mod persistence;
mod select;

pub(crate) use normals::is_same_normal;

use rapier3d::parry::shape::PackedFeatureId;
use vps_core::{Approach, Observer, Pose3};

use self::deep_penetration::recover_deep_penetration;
use self::merge::merge;
use self::normals::resolve_normals;
use self::parameters::{MAX_CONTACTS, PERSISTENCE_TOLERANCE};
use self::persistence::{re_evaluate, should_persist};
use self::select::{limit_per_normal, reduce};
use crate::query::event::{ContactEvent, ContactObserver, PairDropReason, PairEvent};
use crate::query::pair::Pair;
use crate::query::pair_contact::PairContact;

/// Which contacts of a pair an engine gets.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Manifolds {
    /// The deepest contact and those that spread over the largest area (section 3.2), in one
    /// manifold for each normal: four of each, eight in all.
    #[default]
    Reduced,
    /// The deepest contact of each segment of a level of the shell's tree (section 2.4), 1 being the
    /// top, in a manifold of its own. Switch rapier's `contact_clustering` off, which would join them
    /// again.
    Segments(u32),
}

/// The contacts up to `prediction` metres away that an engine gets. `previous` are the ids of the
/// contacts of the step before, and `approach` is how far the shapes have moved since.
pub(crate) fn contacts(
    pair: &Pair<'_>,
    pos12: &Pose3,
    prediction: f32,
    approach: Approach,
    manifolds: Manifolds,
    previous: &[[PackedFeatureId; 2]],
    observer: &impl Observer<PairEvent>,
) -> Vec<PairContact> {
    let mut found = Vec::new();
    for shell in pair.shells(pos12) {
        match manifolds {
            Manifolds::Reduced => shell.manifold::<MAX_CONTACTS>(
                pos12, prediction, approach, previous, observer, &mut found,
            ),
            Manifolds::Segments(level) => {
                shell.segments(pos12, prediction, level, observer, &mut found);
            }
        }
    }
    let by_shells = found.len();
    if let Some(edge_sampler) = pair.edge_sampler() {
        edge_sampler.contacts(pos12, prediction, &mut found);
    }
    let has_edges = found.len() > by_shells;
    let of_new = ContactObserver {
        observer,
        is_previous: false,
    };
    let of_previous = ContactObserver {
        observer,
        is_previous: true,
    };
    of_new.observe_all(&found, ContactEvent::Found);
    let mut of_kept = &of_new;
    match manifolds {
        Manifolds::Reduced => {
            let mut persistent = re_evaluate(pair, pos12, previous, &found);
            merge(&mut found, pair.merging_distance(), &of_new);
            if has_edges || pair.secondary(pos12).is_some() {
                reduce::<MAX_CONTACTS>(&mut found, prediction, approach, &of_new);
            }
            if let Some(persistent) = &mut persistent {
                of_previous.observe_all(persistent, ContactEvent::Found);
                merge(persistent, pair.merging_distance(), &of_previous);
                resolve_normals(persistent, pos12, &of_previous);
                limit_per_normal(persistent, &of_previous);
            }
            resolve_normals(&mut found, pos12, &of_new);
            limit_per_normal(&mut found, &of_new);
            let tolerance = PERSISTENCE_TOLERANCE * pair.size_in_pose(pos12);
            if let Some(persistent) = persistent {
                if should_persist(&persistent, &found, tolerance) {
                    let reason = PairDropReason::PreviousPersist;
                    of_new.observe_all(&found, ContactEvent::Dropped(reason));
                    (found, of_kept) = (persistent, &of_previous);
                } else {
                    let reason = PairDropReason::PreviousReplaced;
                    of_previous.observe_all(&persistent, ContactEvent::Dropped(reason));
                }
            }
            recover_deep_penetration(pair, &mut found, pos12, of_kept);
        }
        Manifolds::Segments(_) if has_edges => {
            let mut by_edges = found.split_off(by_shells);
            reduce::<MAX_CONTACTS>(&mut by_edges, prediction, approach, &of_new);
            found.extend(by_edges);
        }
        Manifolds::Segments(_) => {}
    }
    of_kept.observe_all(&found, ContactEvent::Kept);
    found
}
