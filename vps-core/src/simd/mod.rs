//! Arithmetic on several points at a time, and the choice of the instruction set at run time.

mod lanes;
pub(crate) mod multiversion;
mod vectors;

pub use self::lanes::LANES;
pub(crate) use self::lanes::{first_lanes, lanes_in, padded};
pub use self::vectors::Points;
pub(crate) use self::vectors::{Vectors, Voxels};
