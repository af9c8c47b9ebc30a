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
//! | mesh from a file | [`read_mesh`] (`mesh::read`) | |
//! | health report, thin walls | [`Health`], [`ThinWalls`] (`inspection`) | |
//! | solid from any mesh | `solid` | |
//! | exact depth of a point | [`ExactSolid`] (`solid::exact`) | |
//! | surface voxels, inside, outside | `solid::voxelize` | 2.1.1 |
//! | layers | `field::layers` | 2.1.1 |
//! | closest points and distances | `spatial::bvh`, `field::distance` | 2.1.1 |
//! | sparse storage, curvature bounds | `field::sparse`, `field::curvature` | |
//! | pointshell | `shell::poisson` | 2.1.2 |
//! | clusters and their tree | `shell::tree` | 2.1.2 |
//! | minimal enclosing balls | [`enclosing_ball`] | 2.1.2 |

#![forbid(unsafe_code)]

mod cache;
pub mod enclosing_ball;
mod error;
mod field;
mod file;
mod grid;
mod inspection;
mod mesh;
pub mod models;
mod options;
mod pipeline;
mod shell;
mod solid;
mod spatial;

pub use cache::{AssetCache, BUILDER, CacheError, CachedAsset};
pub use error::BuildError;
pub use file::{FileError, read_asset, write_asset, write_atomically};
pub use inspection::health::Health;
pub use inspection::thin_walls::ThinWalls;
pub use mesh::mass::mass_properties;
pub use mesh::read::{Fault, MeshFormat, ReadError, parse_mesh, read_mesh};
pub use mesh::triangle::closest_point;
pub use mesh::{Mesh, MeshError};
pub use options::{
    BuildOptions, ClosestPoints, Clustering, DENSE_VOXELS, Density, Encoding, PointCount,
    Resolution, Sign,
};
pub use pipeline::{BuildOutput, Stage, build};
pub use solid::exact::{ExactSolid, Penetration};
pub use solid::repair::Repairs;
