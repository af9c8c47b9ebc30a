//! Proofs of queries and fields, on assets of random solids.

mod fields;
mod observers;
mod poses;
mod queries;
// The random solids are those on which the builder is tested.
#[path = "../../../vps-build/tests/it/support.rs"]
mod support;
