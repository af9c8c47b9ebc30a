//! Error bounds of stored values.

/// Error bounds of the values of a [`Voxelmap`](crate::Voxelmap), relative to the exact penetration of
/// the voxel centres.
///
/// ```
/// use vps_core::{Ball, Grid, Vec3, Voxelmap};
///
/// let grid = Grid::new(Vec3::splat(-0.15), 0.01, [30; 3])?;
/// let bounds = Voxelmap::of_field(grid, &Ball::new(0.1))?.error_bounds();
/// assert!(bounds.in_band < 1e-6 && bounds.beyond < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
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
