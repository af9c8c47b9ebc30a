//! Collision algorithms for meshes behind one interface.
//!
//! An algorithm [prepares](CollisionAlgorithm::prepare) a [`Scene`] of a body and a ground, which
//! may take seconds, and returns a [`Prepared`] pair that answers queries. All of them implement
//! the query dispatcher of parry, so that the same pair can be put in a rapier world or queried
//! directly.
//!
//! | adapter | what it does to the mesh |
//! |---|---|
//! | [`Vps`] | pointshell against a voxelmap or an exact cuboid |
//! | [`ConvexHull`] | a hull of few support points (GJK and EPA) |
//! | [`ConvexDecomposition`] | VHACD parts with few vertices each |
//! | [`Trimesh`] | nothing |
//! | [`Voxels`] | filled voxels, each a cube |
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

pub use algorithm::{CollisionAlgorithm, PrepareError};
pub use algorithms::{
    AssetSource, ConvexDecomposition, ConvexHull, Trimesh, Voxels, Vps, VpsGround,
};
pub use contacts::{Contacts, count_and_deepest};
pub use memory::Memory;
pub use prepared::{Dispatcher, Prepared, Size};
pub use scene::{Ground, Scene};
