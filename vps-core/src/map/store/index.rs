//! The index of a sparse store: from voxels to the positions of their values.

use super::layout::{BRICK_VALUES, CellGroup, RefinedCell, is_set, linear_index};
use crate::storage::Storage;

/// The layout of the values of a store.
#[derive(Clone, Debug)]
pub(super) enum Layout<'a> {
    /// One for each voxel.
    Dense,
    /// The lattice, refined cells and bricks.
    Sparse(SparseLayout<'a>),
}

/// The cells of a sparse store, borrowed or owned.
#[derive(Clone, Debug)]
pub(super) struct SparseLayout<'a> {
    pub(super) groups: Storage<'a, CellGroup>,
    pub(super) cells: Storage<'a, RefinedCell>,
    pub(super) cell_dims: [u32; 3],
    /// Index of the first value of the refined cells.
    pub(super) cells_start: usize,
    /// Index of the first value of the bricks.
    pub(super) bricks_start: usize,
}

/// The cells of a sparse store as slices: the bit sets are resolved by rank.
#[derive(Clone, Copy)]
pub(super) struct SparseIndex<'r> {
    pub(super) groups: &'r [CellGroup],
    pub(super) cells: &'r [RefinedCell],
    pub(super) cell_dims: [u32; 3],
    pub(super) cells_start: usize,
    pub(super) bricks_start: usize,
}

impl SparseLayout<'_> {
    #[inline]
    pub(super) fn index(&self) -> SparseIndex<'_> {
        SparseIndex {
            groups: &self.groups,
            cells: &self.cells,
            cell_dims: self.cell_dims,
            cells_start: self.cells_start,
            bricks_start: self.bricks_start,
        }
    }
}

impl SparseIndex<'_> {
    /// Index of the value of a voxel in the refined cell of a rank, if its brick is stored.
    #[inline(always)]
    pub(super) fn stored_value(&self, rank: usize, [x, y, z]: [usize; 3]) -> Option<usize> {
        let cell = self.cells[rank];
        let bit = 1_u64 << (((z / 2) * 4 + y / 2) * 4 + x / 2);
        if cell.bricks & bit == 0 {
            return None;
        }
        let brick_rank = (cell.bricks & (bit - 1)).count_ones();
        let within = ((z % 2) * 2 + y % 2) * 2 + x % 2;
        Some(self.bricks_start + (cell.first_brick + brick_rank) as usize * BRICK_VALUES + within)
    }

    /// Whether neither this cell nor one of its next neighbours is refined.
    #[inline(always)]
    pub(super) fn has_coarse_neighbourhood(&self, cell: [u32; 3]) -> bool {
        let index = linear_index(self.cell_dims, cell);
        is_set(self.groups[index / 64].coarse_neighbourhood, index)
    }

    /// The rank of a cell among the refined ones, if it is refined.
    #[inline(always)]
    pub(super) fn rank(&self, cell: [u32; 3]) -> Option<usize> {
        let index = linear_index(self.cell_dims, cell);
        let group = self.groups[index / 64];
        let bit = 1_u64 << (index % 64);
        if group.refined & bit == 0 {
            return None;
        }
        let rank_in_group = (group.refined & (bit - 1)).count_ones();
        Some((group.rank + rank_in_group) as usize)
    }
}
