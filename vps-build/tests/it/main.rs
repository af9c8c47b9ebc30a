//! Tests of the whole builder.

mod distances;
mod files;
mod invariants;
mod queries;
mod solids;
mod support;
