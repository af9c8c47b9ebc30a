//! The layout of a sparse store: the lattice, refined cells and bricks.

use bytemuck::{Pod, Zeroable};

/// Voxels along the edge of a cell of a sparse [`Store`](crate::raw::Store).
pub const CELL_EDGE_VOXELS: u32 = 8;

/// Values of a refined cell besides those of its bricks: 3 along each edge, 4 voxels apart.
pub const REFINED_CELL_VALUES: usize = 27;

/// Voxels in a brick: 2 along each edge.
pub const BRICK_VALUES: usize = 8;

/// The refined ones among 64 consecutive cells, and the rank of the first.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct CellGroup {
    /// Bit i stands for the i-th of the cells; cells are counted x first, then y, then z.
    pub refined: u64,
    /// Bit i is set if neither cell i nor one of its seven next neighbours (along x, y, z and
    /// diagonally) is refined. All eight voxels around a point of the cell are then interpolated in
    /// the lattice.
    pub coarse_neighbourhood: u64,
    /// The number of refined cells before this group.
    pub rank: u32,
    /// Zero.
    pub reserved: u32,
}

/// A cell with values at a finer spacing than the lattice.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct RefinedCell {
    /// Bit i is set if the i-th of its 4 x 4 x 4 bricks (x first, then y, then z) is stored.
    pub bricks: u64,
    /// Index of its first brick: the number of stored bricks before those of this cell.
    pub first_brick: u32,
    /// Zero.
    pub reserved: u32,
}

/// The number of cells along each axis.
pub fn cell_dims(dims: [u32; 3]) -> [u32; 3] {
    dims.map(|n| n.div_ceil(CELL_EDGE_VOXELS))
}

/// The number of elements of an array. Saturates: no store has that many values.
pub(crate) fn product(dims: [u32; 3]) -> usize {
    dims.iter()
        .fold(1, |count: usize, &n| count.saturating_mul(n as usize))
}

/// Sets [`CellGroup::coarse_neighbourhood`] for a grid of `dims` voxels from the refined cells.
///
/// # Panics
/// If there are too few groups for all cells.
pub fn mark_coarse_neighbourhoods(dims: [u32; 3], groups: &mut [CellGroup]) {
    groups
        .iter_mut()
        .for_each(|group| group.coarse_neighbourhood = 0);
    for_each_cell(dims, |cell, index| {
        let is_coarse = u64::from(has_coarse_neighbourhood(dims, groups, cell));
        groups[index / 64].coarse_neighbourhood |= is_coarse << (index % 64);
    });
}

/// Visits all cells with their indices.
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

/// Whether neither a cell nor one of its next neighbours is refined.
pub(super) fn has_coarse_neighbourhood(
    dims: [u32; 3],
    groups: &[CellGroup],
    cell: [u32; 3],
) -> bool {
    let cell_dims = cell_dims(dims);
    let last = |axis: usize| (cell[axis] + 1).min(cell_dims[axis] - 1);
    for z in cell[2]..=last(2) {
        for y in cell[1]..=last(1) {
            for x in cell[0]..=last(0) {
                let index = linear_index(cell_dims, [x, y, z]);
                if is_set(groups[index / 64].refined, index) {
                    return false;
                }
            }
        }
    }
    true
}

/// Index in an array of `dims` values, x fastest, then y, then z.
#[inline]
pub(super) fn linear_index(dims: [u32; 3], at: [u32; 3]) -> usize {
    let [nx, ny] = [dims[0] as usize, dims[1] as usize];
    (at[2] as usize * ny + at[1] as usize) * nx + at[0] as usize
}

/// Offsets of the four rows of a stencil from its first value.
#[inline(always)]
pub(super) fn row_offsets([nx, ny, _]: [u32; 3]) -> [usize; 4] {
    // The product in 32 bits, so that indices are known not to overflow.
    let (row, plane) = (nx as usize, nx.wrapping_mul(ny) as usize);
    [0, row, plane, plane + row]
}

/// Dimensions of the lattice: one value at the first voxel of each cell and one beyond the last cell.
#[inline(always)]
pub(super) fn lattice_dims([nx, ny, nz]: [u32; 3]) -> [u32; 3] {
    [nx + 1, ny + 1, nz + 1]
}

/// Whether the bit of a cell is set in its group.
#[inline(always)]
pub(super) fn is_set(bits: u64, cell: usize) -> bool {
    bits >> (cell % 64) & 1 == 1
}
