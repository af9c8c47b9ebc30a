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
//! # let (points, normals, areas) = ([[0.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]], [1e-4]);
//! # let clusters = [vps_core::Cluster {
//! #     center: [0.0; 3], radius: 1e-6, normal: [0.0, 1.0, 0.0], thickness: 1e-6,
//! #     lift: 0.0, bulge: 0.0, first: 0, count: 1, parent_point: 0, area: 1e-4,
//! # }];
//! # let levels = [0, 1];
//! # let tree = vps_core::PointSphereTree::new(
//! #     points[..].into(), normals[..].into(), areas[..].into(), clusters[..].into(),
//! #     levels[..].into()).unwrap();
//! let ground = Cuboid::new(Vec3::new(1.0, 0.1, 1.0));
//! // The shell's frame lies 0.09 m above the middle of the ground: 10 mm too deep.
//! let pose = Pose3::from_translation(Vec3::new(0.0, 0.09, 0.0));
//! let query = Query::new(&tree, &ground, pose);
//! let deepest = query.deepest().expect("the point is inside");
//! assert!((deepest.penetration - 0.01).abs() < 1e-6);
//! ```
//!
//! # What to ask
//! | you want | ask | costs |
//! |---|---|---|
//! | does it touch? | [`Query::touches`] | little: ends at the first contact |
//! | the deepest contact δ | [`Query::deepest`] | branch and bound |
//! | how far apart, and where | [`Query::closest`] | branch and bound |
//! | a few contacts for an engine | [`Query::manifold`] | about that of the deepest |
//! | one contact a segment (section 2.4) | [`Query::for_each_segment`] | branch and bound in each |
//! | force and torque (eqs. 2, 3) | [`Query::wrench`] | as many contacts as there are |
//! | those along the field's gradient, and how they change with the pose | [`Query::linear_wrench`] | a little more |
//! | all contacts (Algorithm 1) | [`Query::for_each_contact`] | as many as there are |
//! | as much as there is time for | [`Query::time_critical`] | what you allow |
//! | the same sooner, from one step to the next | [`Query::with_hint`] | a little less |
//! | a fast body not to be missed | [`Sweep::first_contact`] | some touches |
//! | two bodies, either way or both | [`BodyPair`] | one or two queries |
//!
//! [`VirtualCoupling`] makes force and torque for a haptic device of it.
//!
//! # Conventions
//! * **Sign**: penetration is positive inside a solid and negative outside;
//!   [`DistanceField::signed_distance`] is its negative.
//! * **Normals** of shells and gradients of fields point inwards, to deeper penetration.
//! * **Frames**: `shell` is the frame of the pointshell, `field` that of the distance field. A
//!   pose takes shell coordinates to field coordinates. Both are those of their assets: the
//!   coordinates of the mesh less [`Asset::origin`], which is zero unless the mesh lies far away.
//! * **Units** are SI: metres, newtons per metre of stiffness one, newton metres.
//!
//! # Features
//! `std` (default) takes mathematics from the standard library, `libm` from the `libm` crate: one
//! of the two must be on. `alloc` adds structures that own their data. A query never allocates.
//!
//! With `std` on x86-64, queries use AVX2 and its bit counting where the processor has them, with
//! the same results to the bit; without `std` they use what the crate is compiled for
//! (`-C target-cpu`).

#![no_std]
#![deny(unsafe_code)]

#[cfg(feature = "alloc")]
extern crate alloc;
#[cfg(test)]
extern crate std;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

mod aabb;
mod asset;
mod body_pair;
pub mod conformance;
mod coupling;
mod dispatch;
mod field;
pub mod format;
mod function;
mod grid;
mod include;
mod lanes;
mod linear_wrench;
mod manifold;
mod outside;
mod query;
mod sampling;
#[cfg(feature = "alloc")]
mod scale;
mod search;
mod segments;
mod shapes;
mod storage;
pub mod store;
#[cfg(feature = "alloc")]
mod surface_mesh;
mod sweep;
mod time_critical;
mod tree;
mod voxelmap;
mod work;
mod wrench;

pub use aabb::Aabb;
pub use asset::{Asset, MassProperties};
pub use body_pair::{Body, BodyPair, PairContact, Shells, Side};
pub use coupling::{CouplingError, CouplingOptions, StepError, Tool, VirtualCoupling};
pub use field::DistanceField;
#[cfg(feature = "alloc")]
pub use format::encode;
pub use format::{FormatError, VPS_VERSION};
pub use function::FieldFn;
pub use glamx::{Mat3, Pose3, Quat, Vec3};
pub use grid::{Grid, GridError};
pub use include::Aligned;
pub use lanes::{Discs, LANES, Points};
pub use linear_wrench::LinearWrench;
pub use manifold::ContactManifold;
pub use query::{Contact, Query};
pub use sampling::{Linear, LocalPenetration, Trilinear};
#[cfg(feature = "alloc")]
pub use scale::ScaleError;
pub use shapes::{Ball, Capsule, Cuboid, Cylinder, HalfSpace};
pub use storage::Storage;
pub use store::{Store, Values};
#[cfg(feature = "alloc")]
pub use surface_mesh::SurfaceMesh;
pub use sweep::{Impact, Sweep};
pub use time_critical::Estimate;
pub use tree::{Cluster, MAX_LEVELS, PointSphereTree, TreeError};
pub use voxelmap::{Accuracy, BEND_STEPS, UNKNOWN_BEND, Voxelmap, VoxelmapError};
pub use work::{CountWork, Work};
pub use wrench::{Weight, Wrench};
