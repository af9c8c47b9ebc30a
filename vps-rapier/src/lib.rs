//! Voxelmap-Pointshell collision detection for [rapier](rapier3d): arbitrary closed meshes, also
//! concave ones, as solid dynamic bodies (section 3 of Sagardia, Stouraitis and Lopes e Silva,
//! 2014, where the engine was Bullet).
//!
//! Two things are needed: a [`VpsShape`] for a collider, and the [`VpsDispatcher`] in the world's
//! narrow phase, chained to parry's own so that all other pairs collide as before:
//!
//! ```
//! use rapier3d::prelude::*;
//! use vps_rapier::{VpsShapeBuilder, narrow_phase};
//!
//! let (vertices, triangles) = Cuboid::new(Vector::splat(0.5)).to_trimesh();
//! let shape = VpsShapeBuilder::from_triangles(&vertices, &triangles)?.build()?;
//! let mut world = PhysicsWorld { narrow_phase: narrow_phase(), ..PhysicsWorld::default() };
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
//! A VPS shape collides with VPS shapes and with every shape of parry, in compounds too: as a shell
//! in the exact field of a ball, a cuboid or a half-space, or in the [`ShapeField`] of what is near of
//! another, whose documentation says what it makes of surfaces without an interior; and as the field of points on
//! the edges of the other, so that what is smaller than the spacing of the shell's points does not
//! slip between them.

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

#[cfg(feature = "build")]
mod builder;
mod cast;
mod check;
mod compound;
mod contact;
#[cfg(feature = "debug-render")]
mod debug_render;
mod dispatcher;
mod manifolds;
mod pair;
mod probe;
mod real;
mod shape;
mod shape_field;
#[cfg(feature = "serde")]
mod snapshot;
mod surface;
mod surface_field;
mod surroundings;
mod thickness;
mod way;
mod workspace;

use rapier3d::geometry::NarrowPhase;
use rapier3d::parry::query::{DefaultQueryDispatcher, QueryDispatcher};

#[cfg(feature = "build")]
pub use builder::{ShapeError, ShapeInBackground, VpsShapeBuilder};
pub use check::{NoDispatcher, check};
#[cfg(feature = "debug-render")]
pub use debug_render::debug_render;
pub use dispatcher::{Manifolds, Sampling, VpsDispatcher};
pub use shape::{Role, VpsShape};
pub use shape_field::ShapeField;
#[cfg(feature = "serde")]
pub use snapshot::{SavedShapes, Snapshot};

/// A narrow phase with the default [`VpsDispatcher`] before parry's own. Without it VPS shapes meet
/// nothing, see [`check`].
pub fn narrow_phase() -> NarrowPhase {
    NarrowPhase::with_query_dispatcher(VpsDispatcher::default().chain(DefaultQueryDispatcher))
}
