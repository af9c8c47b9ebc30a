//! A regular grid of cubical voxels.

use glamx::Vec3;
use wide::f32x4;

use crate::aabb::Aabb;
use crate::simd::{Vectors, Voxels};

/// A regular grid of cubical voxels (section 2.1.1).
///
/// ```
/// use vps_core::{Grid, Vec3};
///
/// let grid = Grid::new(Vec3::ZERO, 0.5, [4, 3, 2])?;
/// assert_eq!(grid.voxel_at(Vec3::new(0.6, 0.1, 0.9)), [1, 0, 1]);
/// assert_eq!(grid.center([1, 0, 1]), Vec3::new(0.75, 0.25, 0.75));
/// # Ok::<(), vps_core::GridError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    voxel_size: f32,
    per_metre: f32,
    dims: [u32; 3],
    bounds: Aabb,
    // Precomputed, since queries need them for every point.
    center_bounds: Aabb,
    /// Along each axis the last voxel that has a next one.
    last_corner: Vec3,
}

/// Why a [`Grid`] was refused.
///
/// ```
/// use vps_core::{Grid, GridError, Vec3};
///
/// assert_eq!(Grid::new(Vec3::ZERO, 0.0, [4; 3]), Err(GridError::VoxelSize(0.0)));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GridError {
    /// The voxel size is invalid.
    #[error("the voxel size must be positive and finite, not {0} m")]
    VoxelSize(f32),
    /// The origin is not finite.
    #[error("the origin of the grid is not finite: {0}")]
    Origin(Vec3),
    /// The grid has no voxel, or too many to index.
    #[error(
        "a grid of {0} x {1} x {2} voxels is empty, or exceeds 2^31 voxels in all or 2^23 along an axis"
    )]
    Dims(u32, u32, u32),
}

impl Grid {
    /// A grid of `dims` voxels of edge `voxel_size` metres, its lowest corner at `origin` (field
    /// frame).
    ///
    /// # Errors
    /// When the voxel size is not positive, the origin not finite, or the grid empty or larger
    /// than 2^31 voxels, or than 2^23 along an axis, beyond which positions between voxels are
    /// lost to rounding.
    pub fn new(origin: Vec3, voxel_size: f32, dims: [u32; 3]) -> Result<Self, GridError> {
        if !(voxel_size > 0.0 && voxel_size.is_finite()) {
            return Err(GridError::VoxelSize(voxel_size));
        }
        if !origin.is_finite() {
            return Err(GridError::Origin(origin));
        }
        let voxels: u128 = dims.iter().map(|&n| u128::from(n)).product();
        if voxels == 0 || voxels > 1 << 31 || dims.iter().any(|&n| n > 1 << 23) {
            return Err(GridError::Dims(dims[0], dims[1], dims[2]));
        }
        let counts = Vec3::from_array(dims.map(|n| n as f32));
        let (end, half) = (origin + counts * voxel_size, Vec3::splat(0.5 * voxel_size));
        Ok(Self {
            voxel_size,
            per_metre: voxel_size.recip(),
            dims,
            bounds: Aabb {
                min: origin,
                max: end,
            },
            center_bounds: Aabb {
                min: origin + half,
                max: end - half,
            },
            last_corner: (counts - 2.0).max(Vec3::ZERO),
        })
    }

    /// The lowest corner of the grid, in metres in the field frame.
    #[inline]
    pub fn origin(&self) -> Vec3 {
        self.bounds.min
    }

    /// Edge length s of a voxel in metres.
    #[inline]
    pub fn voxel_size(&self) -> f32 {
        self.voxel_size
    }

    /// Voxels per metre, 1 / s.
    #[inline]
    pub(crate) fn per_metre(&self) -> f32 {
        self.per_metre
    }

    /// Voxels along x, y and z.
    #[inline]
    pub fn dims(&self) -> [u32; 3] {
        self.dims
    }

    /// The number of voxels.
    pub fn voxel_count(&self) -> usize {
        self.dims.iter().map(|&n| n as usize).product()
    }

    /// The box of all voxels.
    #[inline]
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// Index of a voxel in an array of all voxels: x fastest, then y, then z.
    #[inline]
    pub fn index(&self, voxel: [u32; 3]) -> usize {
        let [nx, ny, _] = self.dims.map(|n| n as usize);
        let [x, y, z] = voxel.map(|c| c as usize);
        (z * ny + y) * nx + x
    }

    /// Centre C of a voxel in metres in the field frame.
    #[inline]
    pub fn center(&self, voxel: [u32; 3]) -> Vec3 {
        let [x, y, z] = voxel;
        let voxel = Vec3::new(x as f32, y as f32, z as f32);
        self.origin() + (voxel + 0.5) * self.voxel_size
    }

    /// The voxel that contains `point`, or the closest one for a point outside of the grid.
    #[inline]
    pub fn voxel_at(&self, point: Vec3) -> [u32; 3] {
        self.clamped((point - self.origin()) * self.per_metre)
    }

    /// The box between the outermost voxel centres, half a voxel smaller than the grid.
    #[inline]
    pub(crate) fn center_bounds(&self) -> Aabb {
        self.center_bounds
    }

    /// The lowest of the eight voxels whose centres surround each point, and the position of the
    /// point between their centres along each axis, from 0 to 1. The points must lie in
    /// [`center_bounds`](Self::center_bounds), and there must be two voxels along each axis.
    #[inline(always)]
    pub(crate) fn cells_at(&self, points: Vectors) -> (Voxels, Vectors) {
        let axis = |axis: usize, coordinates: f32x4| {
            let at = (coordinates - self.bounds.min[axis]) * self.per_metre - 0.5;
            // At least -0.5, so truncation yields voxel 0 or above.
            let corner = at
                .fast_min(f32x4::splat(self.last_corner[axis]))
                .fast_trunc_int();
            (corner, at - corner.round_float())
        };
        let ((x, u), (y, v), (z, w)) = (axis(0, points.x), axis(1, points.y), axis(2, points.z));
        (Voxels { x, y, z }, Vectors { x: u, y: v, z: w })
    }

    /// The voxel at a position in voxels. The cast saturates, so a NaN becomes voxel 0 and no index
    /// leaves the grid.
    #[inline]
    fn clamped(&self, at: Vec3) -> [u32; 3] {
        let clamp = |at: f32, count: u32| (at as u32).min(count - 1);
        let [nx, ny, nz] = self.dims;
        [clamp(at.x, nx), clamp(at.y, ny), clamp(at.z, nz)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn voxels_contain_their_centres() {
        let grid = Grid::new(Vec3::new(-1.0, 2.0, 0.5), 0.25, [3, 4, 5]).unwrap();
        let mut expected_index = 0;
        for z in 0..5 {
            for y in 0..4 {
                for x in 0..3 {
                    assert_eq!(grid.voxel_at(grid.center([x, y, z])), [x, y, z]);
                    assert_eq!(grid.index([x, y, z]), expected_index);
                    expected_index += 1;
                }
            }
        }
        assert_eq!(grid.voxel_count(), expected_index);
    }

    #[test]
    fn points_outside_belong_to_border_voxels() {
        let grid = Grid::new(Vec3::ZERO, 1.0, [2, 2, 2]).unwrap();
        assert_eq!(grid.voxel_at(Vec3::splat(-9.0)), [0, 0, 0]);
        assert_eq!(grid.voxel_at(Vec3::splat(9.0)), [1, 1, 1]);
        assert_eq!(grid.voxel_at(Vec3::splat(f32::NAN)), [0, 0, 0]);
    }

    #[test]
    fn invalid_grids_are_refused() {
        assert!(Grid::new(Vec3::ZERO, 0.0, [1, 1, 1]).is_err());
        assert!(Grid::new(Vec3::ZERO, f32::NAN, [1, 1, 1]).is_err());
        assert!(Grid::new(Vec3::NAN, 1.0, [1, 1, 1]).is_err());
        assert!(Grid::new(Vec3::ZERO, 1.0, [1, 0, 1]).is_err());
        assert!(Grid::new(Vec3::ZERO, 1.0, [u32::MAX; 3]).is_err());
        assert!(Grid::new(Vec3::ZERO, 1.0, [1 << 24, 2, 2]).is_err());
    }
}
