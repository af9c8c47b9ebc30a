//! Voxelmap-Pointshell collision detection for arbitrarily complex meshes.
//!
//! One body is a [`Voxelmap`], a signed distance field on a regular grid; the other is a
//! pointshell, a cloud of surface points with inward normals, ordered in a
//! [`PointSphereTree`]. A [`Query`] puts the two in a relative pose and finds the points that lie
//! inside the field: contacts with their penetration, a penalty force and torque, and a
//! [`ContactManifold`] for a physics engine. The method is that of Sagardia, Stouraitis and
//! Lopes e Silva (2014); sections and equations in this documentation are those of their paper.
//!
//! ```
//! use vps_core::{Cuboid, Pose3, Query, Vec3};
//! # let (points, normals) = ([[0.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]]);
//! # let clusters = [vps_core::Cluster { center: [0.0; 3], radius: 1e-6, first: 0, count: 1, parent_point: 0 }];
//! # let levels = [0, 1];
//! # let tree = vps_core::PointSphereTree::new(
//! #     points[..].into(), normals[..].into(), clusters[..].into(), levels[..].into()).unwrap();
//! let ground = Cuboid::new(Vec3::new(1.0, 0.1, 1.0));
//! // The shell's frame lies 0.09 m above the middle of the ground: 10 mm too deep.
//! let pose = Pose3::from_translation(Vec3::new(0.0, 0.09, 0.0));
//! let query = Query::new(&tree, &ground, pose);
//! let deepest = query.deepest().expect("the point is inside");
//! assert!((deepest.penetration - 0.01).abs() < 1e-6);
//! ```
//!
//! # Conventions
//! * **Sign**: penetration is positive inside a solid and negative outside;
//!   [`DistanceField::signed_distance`] is its negative.
//! * **Normals** of shells and gradients of fields point inwards, to deeper penetration.
//! * **Frames**: `shell` is the frame of the pointshell, `field` that of the distance field. A
//!   pose takes shell coordinates to field coordinates.
//! * **Units** are SI: metres, newtons per metre of stiffness one, newton metres.
//!
//! # Features
//! `std` (default) takes mathematics from the standard library, `libm` from the `libm` crate: one
//! of the two must be on. `alloc` adds structures that own their data. A query never allocates.

#![no_std]
#![forbid(unsafe_code)]

#[cfg(feature = "alloc")]
extern crate alloc;
#[cfg(test)]
extern crate std;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

mod aabb;
mod asset;
pub mod conformance;
mod field;
pub mod format;
mod grid;
mod manifold;
mod query;
mod shapes;
mod storage;
pub mod store;
mod tree;
mod voxelmap;

pub use aabb::Aabb;
pub use asset::{Asset, MassProperties};
pub use field::DistanceField;
#[cfg(feature = "alloc")]
pub use format::encode;
pub use format::{FormatError, VPS_VERSION};
pub use glamx::{Mat3, Pose3, Quat, Vec3};
pub use grid::{Grid, GridError};
pub use manifold::ContactManifold;
pub use query::{Contact, Query, Wrench};
pub use shapes::{Ball, Cuboid, HalfSpace};
pub use storage::Storage;
pub use store::{Store, Values};
pub use tree::{Cluster, MAX_LEVELS, PointSphereTree, TreeError};
pub use voxelmap::{Accuracy, LocalPenetration, Trilinear, Voxelmap, VoxelmapError};
