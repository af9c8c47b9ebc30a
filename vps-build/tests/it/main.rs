//! Tests of the whole builder.

mod files;
mod invariants;
mod support;
