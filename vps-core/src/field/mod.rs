//! Distance fields: the trait, analytic solids, functions, and the samplings of a voxelmap.

mod analytic;
pub mod conformance;
mod discs;
mod distance_field;
mod extrapolation;
mod function;
mod grid_border;
mod sampling;
#[cfg(feature = "alloc")]
mod to_voxelmap;

pub use self::analytic::{Ball, Capsule, Cuboid, Cylinder, HalfSpace};
pub use self::discs::Discs;
pub use self::distance_field::DistanceField;
pub use self::function::FieldFn;
pub use self::sampling::{Linear, LocalPenetration, Trilinear};
