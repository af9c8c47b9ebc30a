//! A signed distance field on a grid.

use wide::f32x4;

use crate::aabb::Aabb;
use crate::map::error::VoxelmapError;
use crate::map::error_bounds::ErrorBounds;
use crate::map::grid::Grid;
use crate::map::store::{CELL_EDGE_VOXELS, Store, product};
use crate::simd::{LANES, Voxels};
use crate::storage::Storage;

/// A signed distance field on a grid: one value v a voxel, times σ, is the penetration of the
/// voxel's centre (section 2.1.1).
///
/// With σ = s, the voxel size, the values are layers; with σ = λ = 10^-p they are distances
/// truncated to the precision p (eq. 1); with σ = 1 m they are floating-point distances. A map is
/// sampled through one of its views, which differ in the value between the centres:
/// [`local`](Self::local), [`linear`](Self::linear) and [`trilinear`](Self::trilinear).
///
/// ```
/// use vps_core::{Cuboid, DistanceField, Grid, Vec3, Voxelmap};
///
/// let grid = Grid::new(Vec3::splat(-0.2), 0.02, [20; 3])?;
/// let map = Voxelmap::of_field(grid, &Cuboid::new(Vec3::new(0.15, 0.1, 0.1)))?;
/// assert!((map.center_penetration(grid.voxel_at(Vec3::ZERO)) - 0.09).abs() < 1e-6);
/// assert!((map.trilinear().penetration(Vec3::Y * 0.08, Vec3::ZERO) - 0.02).abs() < 1e-3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Voxelmap<'a> {
    grid: Grid,
    sigma: f32,
    solid: Aabb,
    error_bounds: ErrorBounds,
    store: Store<'a>,
    curvature_bounds: Storage<'a, u8>,
}

/// The code of an unknown curvature bound.
pub const CURVATURE_UNKNOWN: u8 = u8::MAX;

/// Steps of a curvature bound per voxel size: a step is s / 127.
pub const CURVATURE_STEPS: f32 = 127.0;

/// The parts of a [`Voxelmap`], for [`Voxelmap::from_parts`].
#[derive(Clone, Debug)]
pub struct VoxelmapParts<'a> {
    /// The grid, in the field frame.
    pub grid: Grid,
    /// Metres of one step of a value.
    pub sigma: f32,
    /// A box around the mesh the map was made from, in the field frame. It lies between the outermost
    /// voxel centres.
    pub solid: Aabb,
    /// Error bounds of the values.
    pub error_bounds: ErrorBounds,
    /// The values, in units of `sigma`; positive inside.
    pub store: Store<'a>,
    /// A curvature bound for each cell of 8 x 8 x 8 voxels (x first, then y, then z), valid in it and in
    /// the cells around it. In steps of s / 127, it bounds from above the second differences of the
    /// values along an axis, and the deviation from a plane of any square of four neighbours; 255 where
    /// it is unknown. It makes queries faster, and must be correct. May be empty.
    pub curvature_bounds: Storage<'a, u8>,
}

impl<'a> Voxelmap<'a> {
    /// A map from its [parts](crate::raw::VoxelmapParts), for builders of maps.
    ///
    /// # Errors
    /// When the parts are inconsistent.
    pub fn from_parts(parts: VoxelmapParts<'a>) -> Result<Self, VoxelmapError> {
        let VoxelmapParts {
            grid,
            sigma,
            solid,
            error_bounds,
            store,
            curvature_bounds,
        } = parts;
        if store.dims() != grid.dims() {
            return Err(VoxelmapError::Dims {
                store: store.dims(),
                grid: grid.dims(),
            });
        }
        let cells = product(store.cell_dims());
        if !curvature_bounds.is_empty() && curvature_bounds.len() != cells {
            return Err(VoxelmapError::CurvatureBounds {
                bounds: curvature_bounds.len(),
                cells,
            });
        }
        if !(sigma > 0.0 && sigma.is_finite()) {
            return Err(VoxelmapError::Sigma(sigma));
        }
        let ErrorBounds {
            in_band,
            beyond,
            narrow_band,
        } = error_bounds;
        if !(in_band >= 0.0 && in_band <= beyond && beyond.is_finite() && narrow_band >= 0.0) {
            return Err(VoxelmapError::ErrorBounds(error_bounds));
        }
        let bounds = grid.center_bounds();
        let tolerance = 0.01 * grid.voxel_size();
        let inside = (solid.min - bounds.min).min_element() >= -tolerance
            && (bounds.max - solid.max).min_element() >= -tolerance
            && (solid.max - solid.min).min_element() >= 0.0;
        if !inside {
            return Err(VoxelmapError::Solid(solid));
        }
        Ok(Self {
            grid,
            sigma,
            solid,
            error_bounds,
            store,
            curvature_bounds,
        })
    }

    /// The grid of the map, in the field frame.
    #[inline]
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Metres of one step of a value: s for layers, λ for scaled distances (eq. 4).
    #[inline]
    pub fn sigma(&self) -> f32 {
        self.sigma
    }

    /// The box around the mesh, in the field frame.
    #[inline]
    pub fn solid(&self) -> Aabb {
        self.solid
    }

    /// Error bounds of the values.
    #[inline]
    pub fn error_bounds(&self) -> ErrorBounds {
        self.error_bounds
    }

    /// The values v; positive inside.
    #[inline]
    pub fn store(&self) -> &Store<'a> {
        &self.store
    }

    /// The curvature bounds of the cells: see [`VoxelmapParts`].
    pub fn curvature_bounds(&self) -> &[u8] {
        &self.curvature_bounds
    }

    /// The curvature bounds around voxels in metres. Unknown ones are huge but finite, so that times a
    /// distance of zero they give zero.
    #[inline(always)]
    pub(crate) fn curvature_bounds_at(&self, voxels: Voxels) -> f32x4 {
        let unknown = f32x4::splat(f32::MAX);
        if self.curvature_bounds.is_empty() {
            return unknown;
        }
        let cells = voxels
            .blocks(CELL_EDGE_VOXELS.ilog2() as i32)
            .linear(self.store.cell_dims());
        let mut steps = [0.0; LANES];
        for lane in 0..LANES {
            steps[lane] = f32::from(self.curvature_bounds[cells[lane]]);
        }
        let steps = f32x4::new(steps);
        let is_unknown = steps.simd_eq(f32x4::splat(f32::from(CURVATURE_UNKNOWN)));
        is_unknown.select(
            unknown,
            steps * (self.grid.voxel_size() * (1.0 / CURVATURE_STEPS)),
        )
    }

    /// V of a voxel's centre in metres.
    #[inline]
    pub fn center_penetration(&self, voxel: [u32; 3]) -> f32 {
        self.store.value(voxel) * self.sigma
    }

    /// The same map owning its values.
    #[cfg(feature = "alloc")]
    pub fn into_owned(self) -> Voxelmap<'static> {
        Voxelmap {
            grid: self.grid,
            sigma: self.sigma,
            solid: self.solid,
            error_bounds: self.error_bounds,
            store: self.store.into_owned(),
            curvature_bounds: self.curvature_bounds.into_owned(),
        }
    }
}
