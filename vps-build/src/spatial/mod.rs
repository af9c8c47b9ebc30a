//! Spatial search: trees over triangles, and points by position.
//!
//! `bvh` finds the closest triangle, `box_tree` the pairs of triangles whose boxes touch. `kd_tree`
//! and `spatial_hash` find points near a point. `lattice` walks the cells of a cubical lattice that a
//! triangle overlaps, decided by `triangle_box`.

pub(crate) mod box_tree;
pub(crate) mod bvh;
pub(crate) mod kd_tree;
pub(crate) mod lattice;
pub(crate) mod spatial_hash;
mod triangle_box;
