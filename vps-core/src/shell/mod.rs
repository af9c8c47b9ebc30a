//! Pointshells, ordered in a tree of clusters.

mod cluster;
mod error;
#[cfg(feature = "alloc")]
mod flat;
mod tree;

pub use self::cluster::{Cluster, ClusterParts};
pub use self::error::TreeError;
pub use self::tree::{MAX_LEVELS, PointSphereTree, TreeParts};
