//! Error bounds of stored values.

/// Error bounds of the values of a [`Voxelmap`](crate::Voxelmap), relative to the exact penetration of
/// the voxel centres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Accuracy {
    /// Largest error in metres in the narrow band, where the value lies within `band_m` of zero.
    pub near_m: f32,
    /// Largest error in metres beyond the narrow band.
    pub far_m: f32,
    /// Half width of the narrow band in metres.
    pub band_m: f32,
}
