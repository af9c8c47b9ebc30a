//! Where the values of a voxel lie.

use super::layout::{BRICK_VALUES, CellGroup, RefinedCell, is_set, linear};
use crate::storage::Storage;

#[derive(Clone, Debug)]
pub(super) enum Layout<'a> {
    Dense,
    Sparse(Sparse<'a>),
}

#[derive(Clone, Debug)]
pub(super) struct Sparse<'a> {
    pub(super) groups: Storage<'a, CellGroup>,
    pub(super) cells: Storage<'a, RefinedCell>,
    pub(super) cell_dims: [u32; 3],
    /// Where the values of refined cells start, and those of bricks.
    pub(super) middles: usize,
    pub(super) bricks: usize,
}

/// The parts of a sparse store.
#[derive(Clone, Copy)]
pub(super) struct Parts<'r> {
    pub(super) groups: &'r [CellGroup],
    pub(super) cells: &'r [RefinedCell],
    pub(super) cell_dims: [u32; 3],
    pub(super) middles: usize,
    pub(super) bricks: usize,
}

impl Sparse<'_> {
    #[inline]
    pub(super) fn parts(&self) -> Parts<'_> {
        Parts {
            groups: &self.groups,
            cells: &self.cells,
            cell_dims: self.cell_dims,
            middles: self.middles,
            bricks: self.bricks,
        }
    }
}

impl Parts<'_> {
    /// Where the value of a voxel of a refined cell is, if it is stored.
    #[inline(always)]
    pub(super) fn brick(&self, number: usize, [x, y, z]: [usize; 3]) -> Option<usize> {
        let cell = self.cells[number];
        let bit = 1_u64 << (((z / 2) * 4 + y / 2) * 4 + x / 2);
        if cell.bricks & bit == 0 {
            return None;
        }
        let before = (cell.bricks & (bit - 1)).count_ones();
        let within = ((z % 2) * 2 + y % 2) * 2 + x % 2;
        Some(self.bricks + (cell.first + before) as usize * BRICK_VALUES + within)
    }

    /// Whether neither this cell nor one of the next ones is refined.
    #[inline(always)]
    pub(super) fn is_plain(&self, cell: [u32; 3]) -> bool {
        let index = linear(self.cell_dims, cell);
        is_set(self.groups[index / 64].plain, index)
    }

    /// The number of a cell among the refined ones, if it is one of them.
    #[inline(always)]
    pub(super) fn refined(&self, cell: [u32; 3]) -> Option<usize> {
        let index = linear(self.cell_dims, cell);
        let group = self.groups[index / 64];
        let bit = 1_u64 << (index % 64);
        if group.refined & bit == 0 {
            return None;
        }
        let before = (group.refined & (bit - 1)).count_ones();
        Some((group.before + before) as usize)
    }
}
