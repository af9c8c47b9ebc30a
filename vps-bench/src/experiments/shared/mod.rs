//! Parts that several kinds of experiments use.

pub(super) mod inertia;
pub(super) mod orientation;
pub(super) mod power_law;
pub(super) mod query_field;
pub(super) mod timed_build;
pub(super) mod tree_query;
pub(super) mod voxelmaps;
pub(super) mod world;
