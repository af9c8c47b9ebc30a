//! Tests of the whole builder.

mod files;
mod invariants;
mod solids;
mod support;
