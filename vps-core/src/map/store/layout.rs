//! Cells, bricks and the lattice of a sparse store.

use bytemuck::{Pod, Zeroable};

/// Voxels along the edge of a cell of a sparse [`Store`](crate::Store).
pub const CELL: u32 = 8;

/// Values a refined cell has of its own: 3 along each edge, 4 voxels apart.
pub const MIDDLE_VALUES: usize = 27;

/// Voxels in a brick: 2 along each edge.
pub const BRICK_VALUES: usize = 8;

/// Which of 64 cells in a row are refined, and how many are before them.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct CellGroup {
    /// Bit i stands for the i-th of the cells; cells are counted x first, then y, then z.
    pub refined: u64,
    /// Which cells are plain: neither they nor the next ones along x, y, z, and across, are refined,
    /// so that the lattice holds for all voxels around a place in them.
    pub plain: u64,
    /// How many cells before these are refined.
    pub before: u32,
    /// Zero.
    pub reserved: u32,
}

/// A cell with values of its own.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct RefinedCell {
    /// Bit i stands for the i-th of its 4 x 4 x 4 bricks (x first, then y, then z): whether the
    /// values of its voxels are stored.
    pub bricks: u64,
    /// How many bricks are stored before those of this cell.
    pub first: u32,
    /// Zero.
    pub reserved: u32,
}

/// How many cells there are along each axis.
pub fn cell_dims(dims: [u32; 3]) -> [u32; 3] {
    dims.map(|n| n.div_ceil(CELL))
}

/// Saturates: no store has as many values.
pub(crate) fn product(dims: [u32; 3]) -> usize {
    dims.iter()
        .fold(1, |count: usize, &n| count.saturating_mul(n as usize))
}

/// Marks the plain cells of a grid of `dims` voxels in groups that say which cells are refined.
///
/// # Panics
/// If there are fewer groups than for all cells.
pub fn mark_plain(dims: [u32; 3], groups: &mut [CellGroup]) {
    groups.iter_mut().for_each(|group| group.plain = 0);
    for_each_cell(dims, |cell, index| {
        let plain = u64::from(is_plain(dims, groups, cell));
        groups[index / 64].plain |= plain << (index % 64);
    });
}

/// All cells with their positions among them.
pub(super) fn for_each_cell(dims: [u32; 3], mut visit: impl FnMut([u32; 3], usize)) {
    let cell_dims = cell_dims(dims);
    let mut index = 0;
    for z in 0..cell_dims[2] {
        for y in 0..cell_dims[1] {
            for x in 0..cell_dims[0] {
                visit([x, y, z], index);
                index += 1;
            }
        }
    }
}

/// Whether neither a cell nor one of the next ones is refined.
pub(super) fn is_plain(dims: [u32; 3], groups: &[CellGroup], cell: [u32; 3]) -> bool {
    let cell_dims = cell_dims(dims);
    let last = |axis: usize| (cell[axis] + 1).min(cell_dims[axis] - 1);
    for z in cell[2]..=last(2) {
        for y in cell[1]..=last(1) {
            for x in cell[0]..=last(0) {
                let index = linear(cell_dims, [x, y, z]);
                if is_set(groups[index / 64].refined, index) {
                    return false;
                }
            }
        }
    }
    true
}

/// Position in an array with x fastest, then y, then z.
#[inline]
pub(super) fn linear(dims: [u32; 3], at: [u32; 3]) -> usize {
    let [nx, ny] = [dims[0] as usize, dims[1] as usize];
    (at[2] as usize * ny + at[1] as usize) * nx + at[0] as usize
}

/// How far the four rows around a place lie from the first.
#[inline(always)]
pub(super) fn row_offsets([nx, ny, _]: [u32; 3]) -> [usize; 4] {
    // The product in 32 bits, so that positions are known not to overflow.
    let (row, plane) = (nx as usize, nx.wrapping_mul(ny) as usize);
    [0, row, plane, plane + row]
}

/// The lattice has a value at the first voxel of each cell and one behind the last.
#[inline(always)]
pub(super) fn lattice_dims([nx, ny, nz]: [u32; 3]) -> [u32; 3] {
    [nx + 1, ny + 1, nz + 1]
}

/// Whether the bit of a cell is set in its group.
#[inline(always)]
pub(super) fn is_set(bits: u64, cell: usize) -> bool {
    bits >> (cell % 64) & 1 == 1
}
