//! Collision algorithms for meshes behind one interface.
//!
//! An algorithm [prepares](CollisionAlgorithm::prepare) a [`Scene`] of a body and a ground, which
//! may take seconds, and returns a [`Prepared`] pair that answers queries. All of them implement
//! the query dispatcher of parry, so that the same pair can be put in a rapier world or queried
//! directly.
//!
//! [`Algorithm`] is the list of all algorithms, which the command and the experiments take from here.
//!
//! [`oracle`] computes exact penetrations.

#![forbid(unsafe_code)]

mod algorithm;
mod algorithms;
mod contacts;
mod memory;
pub mod oracle;
mod precision;
mod prepared;
mod scene;

pub use algorithm::{AssetSource, CollisionAlgorithm, PrepareError, Sizes};
pub use algorithms::*;
pub use contacts::{Contacts, count_and_deepest};
pub use memory::Memory;
pub use prepared::{Dispatcher, Prepared, Size};
pub use scene::{Ground, Scene};
