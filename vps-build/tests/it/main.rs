//! Tests of the whole builder.

mod far;
mod files;
mod invariants;
mod queries;
mod solids;
mod support;
