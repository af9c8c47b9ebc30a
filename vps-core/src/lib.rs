//! Voxelmap-Pointshell collision detection for arbitrarily complex meshes.
//!
//! One body is a [`Voxelmap`], a signed distance field on a regular grid; the other is a
//! pointshell, a cloud of surface points with inward normals in a [`PointSphereTree`]. A [`Query`]
//! places the two in a relative pose and finds the points inside of the field: contacts with their
//! penetration, a penalty force and torque, and a [`ContactManifold`] for a physics engine. The
//! method is that of Sagardia, Stouraitis and Lopes e Silva (2014); sections and equations in this
//! documentation are those of their paper.
//!
//! ```
//! use vps_core::{Cuboid, PointSphereTree, Pose3, Query, Vec3};
//!
//! // A shell of a single point, which stands for 1 cm² of the surface; its normal points up, inwards.
//! let tree = PointSphereTree::flat(&[Vec3::ZERO], &[Vec3::Y], 1e-4)?;
//! let ground = Cuboid::new(Vec3::new(1.0, 0.1, 1.0));
//! // The shell's frame lies 0.09 m above the middle of the ground: 10 mm too deep.
//! let pose = Pose3::from_translation(Vec3::new(0.0, 0.09, 0.0));
//! let query = Query::new(&tree, &ground, pose);
//! let deepest = query.deepest().expect("the point is inside");
//! assert!((deepest.penetration - 0.01).abs() < 1e-6);
//! # Ok::<(), vps_core::TreeError>(())
//! ```
//!
//! # Queries
//! | question | call | cost |
//! |---|---|---|
//! | do the bodies touch? | [`Query::touches`] | low: stops at the first contact |
//! | the deepest contact δ | [`Query::deepest`] | branch and bound |
//! | separation and closest point | [`Query::closest`] | branch and bound |
//! | a few contacts for a physics engine | [`Query::manifold`] | about that of the deepest |
//! | one contact a segment (section 2.4) | [`Query::for_each_segment`] | branch and bound in each |
//! | force and torque (eqs. 2, 3) | [`Query::wrench`] | proportional to the contacts |
//! | the same along the field's gradient, with the derivative by the pose | [`Query::linear_wrench`] | slightly more |
//! | all contacts (Algorithm 1) | [`Query::for_each_contact`] | proportional to the contacts |
//! | an estimate in limited time | [`Query::time_critical`] | as allowed |
//! | warm start from the previous step | [`Query::with_hint`] | slightly less |
//! | the first contact of a fast body | [`Sweep::first_contact`] | several touch tests |
//! | two bodies, with the shell of either or both | [`BodyPair`] | one or two queries |
//!
//! [`Query::observed_by`] tells what a query does, event by event, and why a contact is kept or dropped.
//!
//! [`VirtualCoupling`] turns contacts into force and torque for a haptic device.
//!
//! # Conventions
//! * **Sign**: penetration is positive inside a solid and negative outside;
//!   [`DistanceField::signed_distance`] is its negative.
//! * **Normals** of shells and gradients of fields point inwards, to deeper penetration.
//! * **Frames**: `shell` is the frame of the pointshell, `field` that of the distance field. A
//!   pose transforms shell coordinates to field coordinates. Both are those of their assets: the
//!   coordinates of the mesh less [`Asset::origin`], which is zero unless the mesh lies far away.
//! * **Units** are SI: metres, newtons per metre of stiffness one, newton metres.
//!
//! Most users need the items of this page alone. [`raw`] has the parts of assets, for programs that build
//! them, and the means to evaluate a field at several points at a time.
//!
//! # Features
//! `std` (default) uses mathematics of the standard library, `libm` that of the `libm` crate; one
//! of the two must be enabled. `alloc` adds structures that own their data. A query never
//! allocates.
//!
//! With `std` on x86-64, queries use AVX2 and bit manipulation instructions where the processor has
//! them, with the same results to the bit; without `std` they use the instruction set of the target
//! (`-C target-cpu`).
//!
//! # Targets
//! Little-endian targets of 32 or 64 bits. A `.vps` file is little-endian and used in place, so the
//! crate does not compile for a big-endian target.

#![no_std]
#![deny(unsafe_code)]

#[cfg(feature = "alloc")]
extern crate alloc;
#[cfg(test)]
extern crate std;

#[cfg(target_endian = "big")]
compile_error!("vps-core needs a little-endian target: the bytes of an asset are used in place");

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

mod aabb;
mod asset;
mod field;
mod force;
mod map;
mod query;
pub mod raw;
mod shell;
mod simd;
mod storage;

pub use aabb::Aabb;
#[cfg(feature = "alloc")]
pub use asset::ScaleError;
pub use asset::format::{self, FormatError, VPS_VERSION};
pub use asset::{Aligned, Asset, MassProperties};
pub use field::{
    Ball, Capsule, Cuboid, Cylinder, DistanceField, FieldFn, HalfSpace, Linear, LocalPenetration,
    Trilinear, conformance,
};
pub use force::{
    CouplingError, CouplingOptions, LinearWrench, StepError, Tool, VirtualCoupling, Weight, Wrench,
};
pub use glamx::{Mat3, Pose3, Quat, Vec3};
#[cfg(feature = "alloc")]
pub use map::SurfaceMesh;
pub use map::{ErrorBounds, Grid, GridError, Voxelmap, VoxelmapError};
pub use query::{
    Approach, Body, BodyPair, Contact, ContactManifold, DropReason, Estimate, Event, Fate, Impact,
    Observer, PairContact, Query, Score, Shells, Side, Sweep, Work,
};
pub use shell::{Cluster, PointSphereTree, TreeError};
