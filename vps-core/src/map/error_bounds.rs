//! Error bounds of stored values.

/// Error bounds of the values of a [`Voxelmap`](crate::Voxelmap), relative to the exact penetration of
/// the voxel centres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorBounds {
    /// Largest error in the narrow band, in metres: that of values whose magnitude is at most
    /// `narrow_band`.
    pub in_band: f32,
    /// Largest error beyond the narrow band, in metres; at least `in_band`.
    pub beyond: f32,
    /// Half width of the narrow band around the surface, in metres.
    pub narrow_band: f32,
}
