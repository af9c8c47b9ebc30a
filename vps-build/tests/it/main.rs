//! Tests of the whole builder.

mod brute_force;
mod distances;
mod files;
mod invariants;
mod queries;
mod solids;
mod support;
