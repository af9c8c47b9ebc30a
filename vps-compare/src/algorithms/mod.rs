//! The collision algorithms, one adapter per file.

mod convex_decomposition;
mod convex_hull;
mod parry_pair;
mod simplify_hull;
mod trimesh;
mod voxels;
mod vps;

pub use convex_decomposition::ConvexDecomposition;
pub use convex_hull::ConvexHull;
pub use trimesh::Trimesh;
pub use voxels::Voxels;
pub use vps::{AssetSource, Vps, VpsGround};
