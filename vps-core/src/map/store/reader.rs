//! Reads voxels and interpolates between them, for one type of stored value.

use bytemuck::Zeroable;
use glamx::Vec3;
use wide::f32x4;

use super::index::{Layout, SparseIndex};
use super::layout::{
    BRICK_VALUES, CELL_EDGE_VOXELS, REFINED_CELL_VALUES, is_set, lattice_dims, linear_index,
    row_offsets,
};
use super::trilinear::{TrilinearStencil, interpolated_point, interpolated_voxels};
use super::value::StoredValue;
use crate::simd::{LANES, Points, Vectors, Voxels};

/// A store with the type of its values resolved.
#[derive(Clone, Copy)]
pub(super) struct Reader<'r, T> {
    pub(super) dims: [u32; 3],
    pub(super) layout: &'r Layout<'r>,
    pub(super) values: &'r [T],
}

impl<T: StoredValue> Reader<'_, T> {
    #[inline(always)]
    fn get(&self, index: usize) -> f32 {
        self.values[index].into()
    }

    pub(super) fn value(&self, voxel: [u32; 3]) -> f32 {
        match self.layout {
            Layout::Dense => self.get(linear_index(self.dims, voxel)),
            Layout::Sparse(sparse) => {
                let index = sparse.index();
                let cell = voxel.map(|c| c / CELL_EDGE_VOXELS);
                let local = voxel.map(|c| (c % CELL_EDGE_VOXELS) as usize);
                self.value_in_cell(index, cell, index.rank(cell), local)
            }
        }
    }

    #[inline(always)]
    pub(super) fn interpolated(&self, corners: Voxels, t: Vectors) -> (f32x4, Vectors) {
        match self.layout {
            Layout::Dense => self.interpolated_in_array(corners, self.dims, t),
            Layout::Sparse(sparse) => {
                let index = sparse.index();
                if let Some(interpolated) = self.interpolated_in_lattice(index, corners, t) {
                    return interpolated;
                }
                let mut rows = [[T::Pair::zeroed(); LANES]; 4];
                // Positions between the values of each stencil, which may lie further apart than
                // voxels.
                let mut fractions = Points::from(t);
                let mut per_voxel = [1.0; LANES];
                let mut mixed: [Option<[f32; 8]>; LANES] = [None; LANES];
                for lane in 0..LANES {
                    match self.stencil(index, corners.get(lane)) {
                        Stencil::Stored(values) => {
                            for (row, values) in rows.iter_mut().zip(values) {
                                row[lane] = values;
                            }
                        }
                        Stencil::Coarse(values, local, step) => {
                            for (row, values) in rows.iter_mut().zip(values) {
                                row[lane] = values;
                            }
                            per_voxel[lane] = step;
                            fractions.x[lane] = (local[0] as f32 + fractions.x[lane]) * step;
                            fractions.y[lane] = (local[1] as f32 + fractions.y[lane]) * step;
                            fractions.z[lane] = (local[2] as f32 + fractions.z[lane]) * step;
                        }
                        Stencil::Mixed(values) => mixed[lane] = Some(values),
                    }
                }
                let mut stencil = TrilinearStencil::of::<T>(rows);
                for (lane, mixed) in mixed.into_iter().enumerate() {
                    if let Some(values) = mixed {
                        stencil.set(lane, values);
                    }
                }
                let (value, slope) = stencil.interpolated(fractions.into());
                (value, slope.times(f32x4::new(per_voxel)))
            }
        }
    }

    /// Two neighbouring values.
    #[inline(always)]
    fn pair(&self, first: usize) -> T::Pair {
        T::pair(self.values, first)
    }

    /// Interpolation in the lattice, if all points lie in cells with a coarse neighbourhood.
    #[inline(always)]
    fn interpolated_in_lattice(
        &self,
        index: SparseIndex<'_>,
        corners: Voxels,
        t: Vectors,
    ) -> Option<(f32x4, Vectors)> {
        let cells = corners.blocks(CELL_EDGE_VOXELS.ilog2() as i32);
        for cell in cells.linear(index.cell_dims) {
            if !is_set(index.groups[cell / 64].coarse_neighbourhood, cell) {
                return None;
            }
        }
        let dims = lattice_dims(index.cell_dims);
        let step = 1.0 / CELL_EDGE_VOXELS as f32;
        let within = corners.within(CELL_EDGE_VOXELS as i32 - 1);
        let (value, slope) =
            self.interpolated_in_array(cells, dims, within.plus(t).times(f32x4::splat(step)));
        Some((value, slope.times(f32x4::splat(step))))
    }

    /// Interpolation in a dense array of `dims` values.
    #[inline(always)]
    fn interpolated_in_array(
        &self,
        corners: Voxels,
        dims: [u32; 3],
        t: Vectors,
    ) -> (f32x4, Vectors) {
        let firsts = corners.linear(dims);
        let [_, y, z, yz] = row_offsets(dims);
        // The last row first: its bounds check covers the others.
        let last = self.pairs(firsts, yz);
        let (first, next, high) = (
            self.pairs(firsts, 0),
            self.pairs(firsts, y),
            self.pairs(firsts, z),
        );
        TrilinearStencil::of::<T>([first, next, high, last]).interpolated(t)
    }

    #[inline(always)]
    fn pairs(&self, [a, b, c, d]: [usize; LANES], offset: usize) -> [T::Pair; LANES] {
        [
            self.pair(a + offset),
            self.pair(b + offset),
            self.pair(c + offset),
            self.pair(d + offset),
        ]
    }

    /// The values that the voxel `corner` and its next neighbours are made of.
    #[inline(always)]
    fn stencil(&self, index: SparseIndex<'_>, corner: [u32; 3]) -> Stencil<T::Pair> {
        let [x, y, z] = corner;
        let cell = [
            x / CELL_EDGE_VOXELS,
            y / CELL_EDGE_VOXELS,
            z / CELL_EDGE_VOXELS,
        ];
        let local = [
            (x % CELL_EDGE_VOXELS) as usize,
            (y % CELL_EDGE_VOXELS) as usize,
            (z % CELL_EDGE_VOXELS) as usize,
        ];
        let last = CELL_EDGE_VOXELS as usize - 1;
        let crosses = [local[0] == last, local[1] == last, local[2] == last];
        let in_cell = !(crosses[0] | crosses[1] | crosses[2]);
        let rank = index.rank(cell);
        // The upper faces of a cell carry lattice values, so a cell reaches up to them.
        if index.has_coarse_neighbourhood(cell) || in_cell && rank.is_none() {
            return Stencil::Coarse(
                self.lattice_corners(index, cell),
                local,
                1.0 / CELL_EDGE_VOXELS as f32,
            );
        }
        if let Some(rank) = rank
            && in_cell
        {
            if let Some(rows) = self.stored_rows(index, rank, local) {
                return Stencil::Stored(rows);
            }
            if let Some(octant) = self.octant_stencil(index, rank, local) {
                return octant;
            }
        }
        self.mixed_stencil(index, cell, local, crosses)
    }

    /// The stencil of voxels in several cells, or of stored and interpolated voxels of one cell.
    /// Assembled cell by cell; voxel i of the eight is the next one along the axes of the bits of
    /// i.
    #[inline(always)]
    fn mixed_stencil(
        &self,
        index: SparseIndex<'_>,
        cell: [u32; 3],
        local: [usize; 3],
        crosses: [bool; 3],
    ) -> Stencil<T::Pair> {
        let crossed = (0..3).fold(0, |bits, a| bits | usize::from(crosses[a]) << a);
        let mut values = [0.0; 8];
        for bits in (0..8_usize).filter(|bits| bits & !crossed == 0) {
            let (mut own_cell, mut first) = (cell, local);
            for a in 0..3 {
                if bits >> a & 1 == 1 {
                    own_cell[a] += 1;
                    first[a] = 0;
                }
            }
            let rank = index.rank(own_cell);
            let (rows, size) = match rank {
                None => (
                    self.lattice_corners(index, own_cell),
                    CELL_EDGE_VOXELS as usize,
                ),
                Some(rank) => {
                    let half = CELL_EDGE_VOXELS as usize / 2;
                    let [x, y, z] = first.map(|l| l / half);
                    (self.octant_corners(index, rank, [x, y, z]), half)
                }
            };
            let interpolated =
                interpolated_voxels::<T>(rows, first.map(|l| l % size), crosses, size);
            for i in (0..8).filter(|i| i & crossed == bits) {
                let step = |a: usize| i >> a & 1 & usize::from(!crosses[a]);
                let at = [first[0] + step(0), first[1] + step(1), first[2] + step(2)];
                let stored = rank.and_then(|rank| index.stored_value(rank, at));
                values[i] = stored.map_or(interpolated[i], |position| self.get(position));
            }
        }
        Stencil::Mixed(values)
    }

    /// The rows of the eight voxels from one of a refined cell on, if all are stored.
    #[inline(always)]
    fn stored_rows(
        &self,
        index: SparseIndex<'_>,
        rank: usize,
        [x, y, z]: [usize; 3],
    ) -> Option<[T::Pair; 4]> {
        let cell = index.cells[rank];
        // Neighbouring bricks along x are neighbours in the store as well.
        let pair = 1_u64 << (x / 2) | 1_u64 << x.div_ceil(2);
        let mut rows = [T::Pair::zeroed(); 4];
        for (i, row) in rows.iter_mut().enumerate() {
            let (y, z) = (y + (i & 1), z + (i >> 1));
            let bricks = ((z / 2) * 4 + y / 2) * 4;
            if cell.bricks >> bricks & pair != pair {
                return None;
            }
            let brick_rank = (cell.bricks & ((1 << (bricks + x / 2)) - 1)).count_ones();
            let first =
                index.bricks_start + (cell.first_brick + brick_rank) as usize * BRICK_VALUES;
            let within = first + ((z % 2) * 2 + y % 2) * 2 + x % 2;
            // The next value of this brick, or the first one of the same row of the next brick.
            let next = if x % 2 == 0 { 1 } else { BRICK_VALUES - 1 };
            *row = T::pair_of(self.values[within], self.values[within + next]);
        }
        Some(rows)
    }

    /// The stencil of a voxel in an octant of a refined cell, if it and its next neighbours are all
    /// interpolated there.
    #[inline(always)]
    fn octant_stencil(
        &self,
        index: SparseIndex<'_>,
        rank: usize,
        local: [usize; 3],
    ) -> Option<Stencil<T::Pair>> {
        let [x, y, z] = local;
        let along = |l: usize| 1_u64 << (l / 2) | 1_u64 << l.div_ceil(2);
        // The bits spread to rows of 4 bricks, and to planes of 16.
        let rows = |l: usize| {
            along(l) & 1 | (along(l) & 2) << 3 | (along(l) & 4) << 6 | (along(l) & 8) << 9
        };
        let planes = |l: usize| {
            along(l) & 1 | (along(l) & 2) << 15 | (along(l) & 4) << 30 | (along(l) & 8) << 45
        };
        // No carries: each product places copies of one pattern side by side.
        let bricks = along(x) * rows(y) * planes(z);
        if index.cells[rank].bricks & bricks != 0 {
            return None;
        }
        let octant = [x / 4, y / 4, z / 4];
        let within = [x % 4, y % 4, z % 4];
        Some(Stencil::Coarse(
            self.octant_corners(index, rank, octant),
            within,
            0.25,
        ))
    }

    /// The value of a voxel in a cell, given the rank of the cell if it is refined.
    #[inline(always)]
    fn value_in_cell(
        &self,
        index: SparseIndex<'_>,
        cell: [u32; 3],
        rank: Option<usize>,
        local: [usize; 3],
    ) -> f32 {
        let [x, y, z] = local;
        let Some(rank) = rank else {
            let t = Vec3::new(x as f32, y as f32, z as f32) / CELL_EDGE_VOXELS as f32;
            return interpolated_point::<T>(self.lattice_corners(index, cell), t);
        };
        if let Some(position) = index.stored_value(rank, local) {
            return self.get(position);
        }
        let t = Vec3::new((x % 4) as f32, (y % 4) as f32, (z % 4) as f32) / 4.0;
        interpolated_point::<T>(self.octant_corners(index, rank, [x / 4, y / 4, z / 4]), t)
    }

    /// The rows at the corners of an octant of a refined cell.
    #[inline(always)]
    fn octant_corners(
        &self,
        index: SparseIndex<'_>,
        rank: usize,
        [x, y, z]: [usize; 3],
    ) -> [T::Pair; 4] {
        let first = index.cells_start + rank * REFINED_CELL_VALUES + (z * 3 + y) * 3 + x;
        let row = |offset| self.pair(first + offset);
        [row(0), row(3), row(9), row(12)]
    }

    /// The rows of lattice values at the corners of a cell.
    #[inline(always)]
    fn lattice_corners(&self, index: SparseIndex<'_>, cell: [u32; 3]) -> [T::Pair; 4] {
        let dims = lattice_dims(index.cell_dims);
        let first = linear_index(dims, cell);
        let [a, b, c, d] = row_offsets(dims);
        let row = |offset| self.pair(first + offset);
        [row(a), row(b), row(c), row(d)]
    }
}

/// The values around a point of a sparse store, in rows of two: x fastest, then y, then z.
enum Stencil<P> {
    /// The eight voxels, all stored.
    Stored([P; 4]),
    /// The corners of a cell or an octant, the voxel within it, and the size of a voxel as a fraction
    /// of its edge.
    Coarse([P; 4], [usize; 3], f32),
    /// The eight voxels, some of them interpolated.
    Mixed([f32; 8]),
}
