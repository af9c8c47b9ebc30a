//! Queries about a pair of shapes, at least one of them a VPS shape.
//!
//! A [`pair`] is queried as up to two shells in fields ([`shell_in_field`]) and, against a shape of
//! parry, also as points on the edges of that shape in the voxelmap ([`edge_sampler`], with the points
//! of [`edges`] and their [`sample_id`]s). All of them answer with [`pair_contact`]s; [`event`] tells
//! observers of them. [`cast`] moves a pair along a [`motion`].

pub(crate) mod cast;
mod edge_sampler;
mod edges;
pub(crate) mod event;
pub(crate) mod motion;
pub(crate) mod pair;
pub(crate) mod pair_contact;
mod sample_id;
pub(crate) mod shell_in_field;
