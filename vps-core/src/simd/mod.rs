//! Several points at a time in the registers of a processor, and the choice of its instructions.

mod lanes;
pub(crate) mod multiversion;
mod vectors;

pub use self::lanes::LANES;
pub(crate) use self::lanes::{first_lanes, lanes_in, padded};
pub use self::vectors::Points;
pub(crate) use self::vectors::{Vectors, Voxels};
