//! Pointshells, ordered in a tree of clusters.

mod cluster;
mod error;
mod tree;

pub use self::cluster::Cluster;
pub use self::error::TreeError;
pub use self::tree::{MAX_LEVELS, PointSphereTree};
