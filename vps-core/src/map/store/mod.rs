//! The values of a [`Voxelmap`](crate::Voxelmap), dense or sparse.

mod index;
mod layout;
mod reader;
mod trilinear;
mod value;

use wide::f32x4;

use self::index::{Layout, SparseLayout};
pub(crate) use self::layout::product;
pub use self::layout::{
    BRICK_VALUES, CELL_EDGE_VOXELS, CellGroup, REFINED_CELL_VALUES, RefinedCell, cell_dims,
    mark_coarse_neighbourhoods,
};
use self::layout::{for_each_cell, has_coarse_neighbourhood, is_set, lattice_dims};
use self::reader::Reader;
pub use self::value::Values;
use crate::map::error::VoxelmapError;
use crate::simd::{Vectors, Voxels};
use crate::storage::Storage;

/// One value for every voxel of a grid, stored or interpolated.
///
/// A dense store holds them all, x fastest, then y, then z. A sparse one has two levels:
///
/// * The grid is cut into cells of 8 x 8 x 8 voxels. A lattice of values, one at the first voxel
///   of every cell and one beyond the last along each axis, gives all voxels by trilinear
///   interpolation.
/// * Where that is not accurate enough, a cell is refined: it has 3 x 3 x 3 values of its own, 4
///   voxels apart, between which its voxels are interpolated. Where that is not accurate enough
///   either, mainly close to the surface, the 8 values of a brick of 2 x 2 x 2 voxels are stored.
///
/// The values of the lattice come first, then those of the refined cells, then the bricks. The
/// builder decides about refinement and states the error in [`ErrorBounds`](crate::ErrorBounds).
#[derive(Clone, Debug)]
pub struct Store<'a> {
    dims: [u32; 3],
    cell_dims: [u32; 3],
    values: Values<'a>,
    layout: Layout<'a>,
}

impl<'a> Store<'a> {
    /// A dense store: one value for each of `dims` voxels.
    ///
    /// # Errors
    /// When the number of values is wrong, or one is not finite.
    pub fn dense(dims: [u32; 3], values: Values<'a>) -> Result<Self, VoxelmapError> {
        Self {
            dims,
            cell_dims: cell_dims(dims),
            values,
            layout: Layout::Dense,
        }
        .checked(product(dims))
    }

    /// A sparse store for a grid of `dims` voxels, refined as `groups` and `cells` state.
    ///
    /// # Errors
    /// When the parts do not fit together, or a value is not finite.
    pub fn sparse(
        dims: [u32; 3],
        groups: Storage<'a, CellGroup>,
        cells: Storage<'a, RefinedCell>,
        values: Values<'a>,
    ) -> Result<Self, VoxelmapError> {
        let cell_dims = cell_dims(dims);
        let cell_count = product(cell_dims);
        if groups.len() != cell_count.div_ceil(64) {
            return Err(VoxelmapError::Cells);
        }
        let mut refined = 0_usize;
        for (i, group) in groups.iter().enumerate() {
            let here = (cell_count - 64 * i).min(64);
            let beyond = if here == 64 { 0 } else { !0 << here };
            let bits = group.refined | group.coarse_neighbourhood;
            if group.rank as usize != refined || bits & beyond != 0 {
                return Err(VoxelmapError::Cells);
            }
            refined += group.refined.count_ones() as usize;
        }
        let mut marked = true;
        for_each_cell(dims, |cell, index| {
            marked &= is_set(groups[index / 64].coarse_neighbourhood, index)
                == has_coarse_neighbourhood(dims, &groups, cell);
        });
        if cells.len() != refined || !marked {
            return Err(VoxelmapError::Cells);
        }
        let mut stored = 0_usize;
        for cell in cells.iter() {
            if cell.first_brick as usize != stored {
                return Err(VoxelmapError::Cells);
            }
            stored += cell.bricks.count_ones() as usize;
        }
        let cells_start = product(lattice_dims(cell_dims));
        let bricks_start = cells_start + refined * REFINED_CELL_VALUES;
        let layout = Layout::Sparse(SparseLayout {
            groups,
            cells,
            cell_dims,
            cells_start,
            bricks_start,
        });
        Self {
            dims,
            cell_dims,
            values,
            layout,
        }
        .checked(bricks_start + stored * BRICK_VALUES)
    }

    fn checked(self, expected: usize) -> Result<Self, VoxelmapError> {
        if self.dims.iter().any(|&n| n < 2) {
            return Err(VoxelmapError::Thin(self.dims));
        }
        if self.values.len() != expected {
            return Err(VoxelmapError::ValueCount {
                values: self.values.len(),
                expected,
            });
        }
        if let Values::Floats(values) = &self.values
            && !values.iter().all(|v| v.is_finite())
        {
            return Err(VoxelmapError::NotFinite);
        }
        Ok(self)
    }

    /// The number of cells of 8 x 8 x 8 voxels along x, y and z.
    #[inline]
    pub(crate) fn cell_dims(&self) -> [u32; 3] {
        self.cell_dims
    }

    /// Voxels along x, y and z.
    #[inline]
    pub fn dims(&self) -> [u32; 3] {
        self.dims
    }

    /// All values, in the order of the store.
    pub fn values(&self) -> &Values<'a> {
        &self.values
    }

    /// The groups of cells and the refined cells; both are empty for a dense store.
    pub fn cells(&self) -> (&[CellGroup], &[RefinedCell]) {
        match &self.layout {
            Layout::Dense => (&[], &[]),
            Layout::Sparse(sparse) => (&sparse.groups, &sparse.cells),
        }
    }

    /// Whether the value of every voxel is stored.
    pub fn is_dense(&self) -> bool {
        matches!(self.layout, Layout::Dense)
    }

    /// Size in memory in bytes; the same in a file, without padding.
    pub fn byte_len(&self) -> usize {
        let (groups, cells) = self.cells();
        self.values.bytes().len() + size_of_val(groups) + size_of_val(cells)
    }

    /// The value of a voxel.
    #[inline]
    pub fn value(&self, voxel: [u32; 3]) -> f32 {
        match &self.values {
            Values::Integers(values) => self.read(values).value(voxel),
            Values::Floats(values) => self.read(values).value(voxel),
        }
    }

    /// Trilinear interpolation between the voxels `corners` and their next neighbours at `t` (0 to 1
    /// along each axis), and its gradient per voxel.
    #[inline(always)]
    pub(crate) fn interpolated(&self, corners: Voxels, t: Vectors) -> (f32x4, Vectors) {
        match &self.values {
            Values::Integers(values) => self.read(values).interpolated(corners, t),
            Values::Floats(values) => self.read(values).interpolated(corners, t),
        }
    }

    #[inline(always)]
    fn read<'r, T>(&'r self, values: &'r [T]) -> Reader<'r, T> {
        Reader {
            dims: self.dims,
            layout: &self.layout,
            values,
        }
    }

    #[cfg(feature = "alloc")]
    pub(crate) fn into_owned(self) -> Store<'static> {
        Store {
            dims: self.dims,
            cell_dims: self.cell_dims,
            values: self.values.into_owned(),
            layout: match self.layout {
                Layout::Dense => Layout::Dense,
                Layout::Sparse(sparse) => Layout::Sparse(SparseLayout {
                    groups: sparse.groups.into_owned(),
                    cells: sparse.cells.into_owned(),
                    ..sparse
                }),
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use std::vec;
    use std::vec::Vec;

    use glamx::Vec3;
    use wide::i32x4;

    use super::*;

    const DIMS: [u32; 3] = [17, 9, 8];

    /// Three by two by one cells; the second and the last are refined, and in the latter two
    /// bricks are stored.
    fn store(values: Vec<i16>) -> Result<Store<'static>, VoxelmapError> {
        let mut groups = vec![CellGroup {
            refined: 0b10_0010,
            ..CellGroup::default()
        }];
        mark_coarse_neighbourhoods(DIMS, &mut groups);
        assert_eq!(groups[0].coarse_neighbourhood, 0b001000);
        let cells = vec![
            RefinedCell::default(),
            RefinedCell {
                bricks: 0b100_0001,
                ..RefinedCell::default()
            },
        ];
        Store::sparse(
            DIMS,
            groups.into(),
            cells.into(),
            Values::Integers(values.into()),
        )
    }

    fn numbered() -> Vec<i16> {
        (0..4 * 3 * 2 + 2 * 27 + 2 * 8).collect()
    }

    #[test]
    fn each_voxel_has_its_value() {
        let store = store(numbered()).unwrap();
        // The lattice: 4 x 3 x 2 values.
        assert_eq!(store.value([0, 0, 0]), 0.0);
        assert_eq!(store.value([0, 8, 0]), 4.0);
        assert_eq!(store.value([4, 0, 0]), 0.5);
        assert_eq!(store.value([4, 4, 4]), 0.5 + 2.0 + 6.0);
        // The refined cell next to it starts with value 24.
        assert_eq!(store.value([8, 0, 0]), 24.0);
        assert_eq!(store.value([12, 4, 4]), 24.0 + 13.0);
        assert_eq!(store.value([13, 0, 0]), 25.25);
        assert_eq!(
            store.value([15, 7, 7]),
            24.0 + 1.75 + 3.0 * 1.75 + 9.0 * 1.75
        );
        // The last one: bricks at 78 and 86, the rest interpolated from 51 on.
        assert_eq!(store.value([16, 8, 0]), 78.0);
        assert_eq!(store.value([16, 8, 1]), 82.0);
        assert_eq!(store.value([16, 8, 2]), 51.0 + 9.0 * 0.5);
    }

    /// The shortcuts of interpolation against a dense store.
    #[test]
    fn sparse_interpolation_equals_dense_interpolation() {
        let sparse = store(numbered()).unwrap();
        let mut all = Vec::new();
        for z in 0..DIMS[2] {
            for y in 0..DIMS[1] {
                for x in 0..DIMS[0] {
                    all.push(sparse.value([x, y, z]));
                }
            }
        }
        let dense = Store::dense(DIMS, Values::Floats(all.into())).unwrap();
        for z in 0..DIMS[2] - 1 {
            for y in 0..DIMS[1] - 1 {
                for x in 0..DIMS[0] - 1 {
                    for t in [Vec3::ZERO, Vec3::ONE, Vec3::new(0.2, 0.9, 0.4)] {
                        let [a, b] = [&sparse, &dense].map(|s| {
                            let [x, y, z] = [x, y, z].map(|c| i32x4::splat(c as i32));
                            let (value, _) = s.interpolated(Voxels { x, y, z }, Vectors::splat(t));
                            value.to_array()[0]
                        });
                        assert!((a - b).abs() < 1e-4, "{x} {y} {z} {t}: {a} {b}");
                    }
                }
            }
        }
    }

    #[test]
    fn inconsistent_parts_are_refused() {
        let mut fewer = numbered();
        fewer.pop();
        assert!(matches!(
            store(fewer),
            Err(VoxelmapError::ValueCount { expected: 94, .. })
        ));
        let refused = |groups: Vec<CellGroup>, cells: Vec<RefinedCell>| {
            let values = Values::Integers(numbered().into());
            matches!(
                Store::sparse(DIMS, groups.into(), cells.into(), values),
                Err(VoxelmapError::Cells)
            )
        };
        let group = |refined, rank| {
            let mut group = [CellGroup {
                refined,
                rank,
                ..CellGroup::default()
            }];
            mark_coarse_neighbourhoods(DIMS, &mut group);
            group[0]
        };
        let cell = |bricks, first_brick| RefinedCell {
            bricks,
            first_brick,
            reserved: 0,
        };
        assert!(!refused(vec![group(3, 0)], vec![cell(1, 0), cell(1, 1)]));
        assert!(refused(vec![], vec![]));
        assert!(refused(vec![group(3, 1)], vec![cell(1, 0), cell(1, 1)]));
        assert!(refused(vec![group(3, 0)], vec![cell(1, 0), cell(1, 0)]));
        assert!(refused(vec![group(3, 0)], vec![cell(3, 0)]));
        // A seventh cell, where there are six.
        assert!(refused(vec![group(65, 0)], vec![cell(1, 0), cell(1, 1)]));
        let none = || Values::Integers(Vec::new().into());
        assert!(Store::dense([u32::MAX; 3], none()).is_err());
        assert!(
            Store::sparse([u32::MAX; 3], Vec::new().into(), Vec::new().into(), none()).is_err()
        );
        let infinite = Values::Floats(vec![f32::NAN; 17 * 9 * 8].into());
        assert!(matches!(
            Store::dense(DIMS, infinite),
            Err(VoxelmapError::NotFinite)
        ));
    }
}
