//! Queries of a point-sphere tree by name.

use std::hint::black_box;

use serde::{Deserialize, Serialize};
use vps_core::{DistanceField, Observer, Query, Vec3, Weight};

/// A query of a point-sphere tree.
#[derive(Clone, Copy, Debug, Deserialize, Eq, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum TreeQuery {
    Touches,
    Deepest,
    /// The manifold of four contacts.
    Manifold,
    /// Force and torque of all contacts, weighted by area.
    Wrench,
    /// The deepest contact of each segment of a level.
    Segments(u32),
}

impl TreeQuery {
    /// Executes the query; its result is computed and dropped.
    pub(crate) fn execute<F: DistanceField, W: Observer + Copy>(self, query: &Query<'_, F, W>) {
        match self {
            Self::Touches => _ = black_box(query.touches()),
            Self::Deepest => _ = black_box(query.deepest()),
            Self::Manifold => _ = black_box(query.manifold::<4>()),
            Self::Wrench => _ = black_box(query.wrench(Vec3::ZERO, Weight::Area)),
            Self::Segments(level) => {
                let mut sum = 0.0;
                query.for_each_segment(level, |_, contact| sum += contact.penetration);
                _ = black_box(sum);
            }
        }
    }
}
