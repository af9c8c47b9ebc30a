//! Tests of the whole builder.

mod files;
mod invariants;
mod queries;
mod solids;
mod support;
