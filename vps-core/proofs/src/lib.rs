//! Proofs of queries and fields, on assets of random solids. They are tests of `vps-core` in a crate of
//! their own, because they need the builder and take longer than its other tests.
#![cfg(test)]

mod fields;
mod observers;
mod poses;
mod queries;
mod refinement;
// The random solids are those on which the builder is tested.
#[path = "../../../vps-build/tests/it/support.rs"]
mod support;
