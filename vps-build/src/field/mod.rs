//! The signed distance field of a solid, sampled at voxels (section 2.1.1).
//!
//! `distance` computes penetrations, `layers` the layers of the paper. `lattice` samples them at the
//! corners of cells, `quantize` makes stored values of them, `sparse` refines cells where interpolation
//! is not accurate enough, and `curvature` bounds second differences. `voxelmap` puts all of it
//! together.

mod curvature;
mod distance;
mod lattice;
mod layers;
mod quantize;
mod sparse;
pub(crate) mod voxelmap;
