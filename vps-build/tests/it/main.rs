//! Tests of the whole builder.

mod brute_force;
mod distances;
mod files;
mod invariants;
mod solids;
mod support;
