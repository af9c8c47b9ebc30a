//! The samplings of a voxelmap: penetration between the centres of voxels.

mod error_model;
mod linear;
mod local;
mod trilinear;
mod voxel_bound;

pub use self::linear::Linear;
pub use self::local::LocalPenetration;
pub use self::trilinear::Trilinear;

/// Half the diagonal of a voxel, in voxels.
const HALF_DIAGONAL: f32 = 0.866_025_4;

const SQRT_3: f32 = 1.732_050_8;
