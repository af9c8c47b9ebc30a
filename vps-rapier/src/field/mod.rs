//! Shapes as distance fields, in which the shell of a VPS shape is queried.
//!
//! [`shape_field`] makes a field of any shape of parry; [`surface_field`] does so for triangle meshes
//! and height fields, from their triangles near the shell ([`surface`], [`facet`], [`adjacency`],
//! [`facet_tree`]), or as one plane ([`plane`]). [`extended_map`] continues the field of a voxelmap
//! beyond its grid.

mod adjacency;
pub(crate) mod bounds;
pub(crate) mod extended_map;
mod facet;
mod facet_tree;
mod plane;
pub(crate) mod shape_field;
pub(crate) mod surface;
mod surface_field;
