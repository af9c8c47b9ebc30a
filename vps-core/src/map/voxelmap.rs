//! A signed distance field on a grid.

use wide::f32x4;

use crate::aabb::Aabb;
use crate::map::accuracy::Accuracy;
use crate::map::error::VoxelmapError;
use crate::map::grid::Grid;
use crate::map::store::{CELL, Store, product};
use crate::simd::{LANES, Voxels};
use crate::storage::Storage;

/// A signed distance field on a grid: one value v a voxel, times σ, is the penetration of the
/// voxel's centre (section 2.1.1).
///
/// With σ = s, the voxel size, the values are layers; with σ = λ = 10^-p they are distances
/// truncated to the precision p (eq. 1); with σ = 1 m they are floating-point distances. A map is
/// sampled through one of its views, which differ in what they make of a point between the
/// centres: [`local`](Self::local), [`linear`](Self::linear) and [`trilinear`](Self::trilinear).
#[derive(Clone, Debug)]
pub struct Voxelmap<'a> {
    grid: Grid,
    sigma: f32,
    solid: Aabb,
    accuracy: Accuracy,
    store: Store<'a>,
    bends: Storage<'a, u8>,
}

/// A bend that is not known.
pub const UNKNOWN_BEND: u8 = u8::MAX;

/// How many steps of a bend are the voxel size.
pub const BEND_STEPS: f32 = 127.0;

impl<'a> Voxelmap<'a> {
    /// A map over `grid` with the values of `store`, each worth `sigma` metres; `solid` is a box
    /// around the mesh the map was made from, and lies between the outermost voxel centres.
    ///
    /// `bends` says for each cell of 8 x 8 x 8 voxels (x first, then y, then z) how little the field
    /// bends in it and in the cells around it: in steps of s / 127, a bound on how much any value
    /// there is below the middle of its two neighbours along an axis, doubled, and on how far any
    /// square of four neighbours is from a plane; 255 where it is not known. It makes queries
    /// faster, and must be true; without any, nothing is known.
    ///
    /// # Errors
    /// When the parts do not fit together.
    pub fn new(
        grid: Grid,
        sigma: f32,
        solid: Aabb,
        accuracy: Accuracy,
        store: Store<'a>,
        bends: Storage<'a, u8>,
    ) -> Result<Self, VoxelmapError> {
        if store.dims() != grid.dims() {
            return Err(VoxelmapError::Dims {
                store: store.dims(),
                grid: grid.dims(),
            });
        }
        let cells = product(store.cell_dims());
        if !bends.is_empty() && bends.len() != cells {
            return Err(VoxelmapError::Bends {
                bends: bends.len(),
                cells,
            });
        }
        if !(sigma > 0.0 && sigma.is_finite()) {
            return Err(VoxelmapError::Sigma(sigma));
        }
        let Accuracy {
            near_m,
            far_m,
            band_m,
        } = accuracy;
        if !(near_m >= 0.0 && near_m <= far_m && far_m.is_finite() && band_m >= 0.0) {
            return Err(VoxelmapError::Accuracy(accuracy));
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
            accuracy,
            store,
            bends,
        })
    }

    /// The grid of the map, in the field frame.
    #[inline]
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// What one step of a value is worth in metres: s for layers, λ for scaled distances (eq. 4).
    #[inline]
    pub fn sigma(&self) -> f32 {
        self.sigma
    }

    /// The box around the mesh, in the field frame.
    #[inline]
    pub fn solid(&self) -> Aabb {
        self.solid
    }

    /// What is known about the error of the values.
    #[inline]
    pub fn accuracy(&self) -> Accuracy {
        self.accuracy
    }

    /// Where the values v are; positive inside.
    #[inline]
    pub fn store(&self) -> &Store<'a> {
        &self.store
    }

    /// How much the field bends, cell by cell: see [`new`](Self::new).
    pub fn bends(&self) -> &[u8] {
        &self.bends
    }

    /// The bends around voxels in metres, enormous where they are not known (but finite: over no way
    /// at all nothing bends).
    #[inline(always)]
    pub(crate) fn bends_at(&self, voxels: Voxels) -> f32x4 {
        let enormous = f32x4::splat(f32::MAX);
        if self.bends.is_empty() {
            return enormous;
        }
        let cells = voxels
            .blocks(CELL.ilog2() as i32)
            .linear(self.store.cell_dims());
        let mut steps = [0.0; LANES];
        for lane in 0..LANES {
            steps[lane] = f32::from(self.bends[cells[lane]]);
        }
        let steps = f32x4::new(steps);
        let is_unknown = steps.simd_eq(f32x4::splat(f32::from(UNKNOWN_BEND)));
        is_unknown.select(
            enormous,
            steps * (self.grid.voxel_size() * (1.0 / BEND_STEPS)),
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
            accuracy: self.accuracy,
            store: self.store.into_owned(),
            bends: self.bends.into_owned(),
        }
    }
}
