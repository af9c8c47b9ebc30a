//! Builds Voxelmap-Pointshell assets from triangle meshes (section 2.1 of Sagardia, Stouraitis
//! and Lopes e Silva, 2014).
//!
//! ```
//! use vps_build::{BuildOptions, Mesh, PointCount, Resolution, build};
//!
//! let mesh = Mesh::cuboid([0.2, 0.1, 0.1])?;
//! let options = BuildOptions {
//!     resolution: Resolution::VoxelSize(0.01),
//!     margin: 3,
//!     points: PointCount::About(500),
//!     ..BuildOptions::default()
//! };
//! let asset = build(&mesh, &options, &|_stage| ())?.asset;
//! assert_eq!(asset.voxelmap.grid().dims(), [26, 16, 16]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! | step | module | in the paper |
//! |---|---|---|
//! | mesh from a file | [`read_mesh`] | |
//! | what is wrong with it | [`Health`] | |
//! | how deep a point is in it, exactly | [`ExactSolid`] | |
//! | a solid from any mesh | `solid`, `winding`, `solid_angle` | |
//! | walls thinner than a voxel | [`ThinWalls`] | |
//! | surface voxels, inside, outside | `places` | 2.1.1 |
//! | layers | `layers` | 2.1.1 |
//! | closest points and distances | `bvh`, `distance` | 2.1.1 |
//! | what may be interpolated | `sparse` | |
//! | pointshell | `sample` | 2.1.2 |
//! | clusters and their tree | `cluster`, `halves`, `nearest` | 2.1.2 |
//! | minimal enclosing balls | [`ball`] | 2.1.2 |

#![forbid(unsafe_code)]

pub mod ball;
mod bends;
mod build;
mod bvh;
mod cache;
mod cells;
mod cluster;
mod distance;
mod edges;
mod exact_solid;
mod file;
mod flat;
mod frame;
mod halves;
mod health;
mod kdtree;
mod layers;
mod mass;
mod mesh;
pub mod models;
mod nearest;
mod places;
mod read;
mod sample;
mod sat;
mod solid;
mod solid_angle;
mod sparse;
mod thin_walls;
mod triangle;
mod winding;

pub use build::{
    BuildError, BuildOptions, Built, ClosestPoints, Clustering, DENSE_VOXELS, Density, Encoding,
    PointCount, Resolution, Stage, build,
};
pub use cache::{AssetCache, BUILDER, CacheError, CachedAsset};
pub use exact_solid::{ExactSolid, Penetration};
pub use file::{FileError, read_asset, write_asset, write_atomically};
pub use health::Health;
pub use mass::mass_properties;
pub use mesh::{Mesh, MeshError};
pub use read::{Fault, MeshFormat, ReadError, parse_mesh, read_mesh};
pub use solid::{Repairs, Sign};
pub use thin_walls::ThinWalls;
pub use triangle::closest_point;
