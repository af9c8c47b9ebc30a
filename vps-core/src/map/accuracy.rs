//! What is known of the error of stored values.

/// How far the values of a [`Voxelmap`](crate::Voxelmap) may be from the exact penetration of the voxel centres in
/// the solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Accuracy {
    /// Largest error in metres where the value lies within `band_m` of zero.
    pub near_m: f32,
    /// Largest error in metres anywhere else.
    pub far_m: f32,
    /// Where near ends, in metres.
    pub band_m: f32,
}
