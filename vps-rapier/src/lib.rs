//! Voxelmap-Pointshell collision detection for [rapier](rapier3d): arbitrary closed meshes, also
//! concave ones, as solid dynamic bodies (section 3 of Sagardia, Stouraitis and Lopes e Silva,
//! 2014, where the engine was Bullet).
//!
//! Two things are needed: a [`VpsShape`] for a collider, and a world [`set_up`] for it: with the
//! [`VpsDispatcher`] in its narrow phase, chained to parry's own so that all other pairs collide as
//! before, and with tolerances in proportion to the bodies.
//!
//! ```
//! use rapier3d::prelude::*;
//! use vps_rapier::{VpsShapeBuilder, set_up};
//!
//! let (vertices, triangles) = Cuboid::new(Vector::splat(0.5)).to_trimesh();
//! let shape = VpsShapeBuilder::from_triangles(&vertices, &triangles)?.build()?;
//! let mut world = PhysicsWorld::default();
//! set_up(&mut world.narrow_phase, &mut world.integration_parameters, 1.0);
//! world.insert(RigidBodyBuilder::fixed(), ColliderBuilder::cuboid(5.0, 0.1, 5.0));
//! let above = RigidBodyBuilder::dynamic().translation(Vector::new(0.0, 1.0, 0.0));
//! let (body, _) = world.insert(above, ColliderBuilder::new(shape.into()));
//! for _ in 0..120 {
//!     world.step();
//! }
//! assert!((world.bodies[body].translation().y - 0.6).abs() < 0.01);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # What collides
//! A VPS shape collides with VPS shapes and with every shape of parry, in compounds too. Its shell is
//! queried in the exact field of a ball, a cuboid or a half-space, and in the [`ShapeField`] of any
//! other shape of parry, which also defines a field of surfaces without an interior. Its voxelmap
//! is sampled at points on the edges of the other shape, so that shapes smaller than the spacing of
//! the shell's points do not slip between them.

// Rooms, each of which uses only those before it:
// precision, shape (the asset as a shape), field (other shapes as distance fields), query (about a
// pair), reduce (from all contacts to a few), manifolds and compound (the data of rapier), dispatcher,
// set_up.
#![forbid(unsafe_code)]

#[cfg(all(feature = "f32", feature = "f64"))]
compile_error!("choose one of the features f32 and f64, the second with default-features = false");
#[cfg(not(any(feature = "f32", feature = "f64")))]
compile_error!("choose one of the features f32 and f64");

#[cfg(feature = "f32")]
pub extern crate rapier3d;
#[cfg(feature = "f64")]
pub extern crate rapier3d_f64 as rapier3d;

#[cfg(feature = "build")]
pub use vps_build;
pub use vps_core;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

mod check;
mod compound;
#[cfg(feature = "debug-render")]
mod debug_render;
mod dispatcher;
mod field;
mod manifolds;
mod precision;
mod query;
mod reduce;
mod set_up;
mod shape;
#[cfg(feature = "serde")]
mod snapshot;
mod warnings;
mod workspace;

pub use check::{WorldError, check};
#[cfg(feature = "debug-render")]
pub use debug_render::debug_render;
pub use dispatcher::VpsDispatcher;
pub use field::shape_field::ShapeField;
pub use query::event::{ContactEvent, PairDropReason, PairEvent, TurnReason};
pub use query::pair_contact::PairContact;
pub use query::shell_in_field::{ContactPoints, Sampling};
pub use reduce::Manifolds;
pub use set_up::{narrow_phase, set_up};
#[cfg(feature = "build")]
pub use shape::builder::{PendingShape, ShapeError, VpsShapeBuilder};
pub use shape::{Role, VpsShape};
#[cfg(feature = "serde")]
pub use snapshot::Snapshot;
#[cfg(feature = "serde")]
pub use snapshot::shape_snapshot::ShapeSnapshot;
