//! Values of voxels, and interpolation between them, for one kind of value.

use bytemuck::Zeroable;
use glamx::Vec3;
use wide::f32x4;

use super::index::{Layout, Parts};
use super::layout::{BRICK_VALUES, CELL, MIDDLE_VALUES, is_set, lattice_dims, linear, row_offsets};
use super::trilinear::{Eight, at, between};
use super::value::Value;
use crate::simd::{LANES, Points, Vectors, Voxels};

/// A store whose values are known to be of one kind.
#[derive(Clone, Copy)]
pub(super) struct Reader<'r, T> {
    pub(super) dims: [u32; 3],
    pub(super) layout: &'r Layout<'r>,
    pub(super) values: &'r [T],
}

impl<T: Value> Reader<'_, T> {
    #[inline(always)]
    fn get(&self, index: usize) -> f32 {
        self.values[index].into()
    }

    pub(super) fn value(&self, voxel: [u32; 3]) -> f32 {
        match self.layout {
            Layout::Dense => self.get(linear(self.dims, voxel)),
            Layout::Sparse(sparse) => {
                let parts = sparse.parts();
                let cell = voxel.map(|c| c / CELL);
                let local = voxel.map(|c| (c % CELL) as usize);
                self.value_in(parts, cell, parts.refined(cell), local)
            }
        }
    }

    #[inline(always)]
    pub(super) fn interpolated(&self, corners: Voxels, t: Vectors) -> (f32x4, Vectors) {
        match self.layout {
            Layout::Dense => self.at_rows(corners, self.dims, t),
            Layout::Sparse(sparse) => {
                let parts = sparse.parts();
                if let Some(found) = self.in_lattice(parts, corners, t) {
                    return found;
                }
                let mut rows = [[T::Pair::zeroed(); LANES]; 4];
                // Values that lie further apart than voxels, and where between them.
                let mut between = Points::from(t);
                let mut per_voxel = [1.0; LANES];
                let mut mixed: [Option<[f32; 8]>; LANES] = [None; LANES];
                for lane in 0..LANES {
                    match self.around(parts, corners.get(lane)) {
                        Around::Rows(values) => {
                            for (row, values) in rows.iter_mut().zip(values) {
                                row[lane] = values;
                            }
                        }
                        Around::Coarse(values, local, step) => {
                            for (row, values) in rows.iter_mut().zip(values) {
                                row[lane] = values;
                            }
                            per_voxel[lane] = step;
                            between.x[lane] = (local[0] as f32 + between.x[lane]) * step;
                            between.y[lane] = (local[1] as f32 + between.y[lane]) * step;
                            between.z[lane] = (local[2] as f32 + between.z[lane]) * step;
                        }
                        Around::Mixed(values) => mixed[lane] = Some(values),
                    }
                }
                let mut eight = Eight::of::<T>(rows);
                for (lane, mixed) in mixed.into_iter().enumerate() {
                    if let Some(values) = mixed {
                        eight.set(lane, values);
                    }
                }
                let (value, slope) = eight.interpolated(between.into());
                (value, slope.times(f32x4::new(per_voxel)))
            }
        }
    }

    /// Two values next to each other.
    #[inline(always)]
    fn pair(&self, first: usize) -> T::Pair {
        T::pair(self.values, first)
    }

    /// The same if all the voxels around are interpolated in the lattice.
    #[inline(always)]
    fn in_lattice(
        &self,
        parts: Parts<'_>,
        corners: Voxels,
        t: Vectors,
    ) -> Option<(f32x4, Vectors)> {
        let cells = corners.blocks(CELL.ilog2() as i32);
        for cell in cells.linear(parts.cell_dims) {
            if !is_set(parts.groups[cell / 64].plain, cell) {
                return None;
            }
        }
        let dims = lattice_dims(parts.cell_dims);
        let step = 1.0 / CELL as f32;
        let within = corners.within(CELL as i32 - 1);
        let (value, slope) = self.at_rows(cells, dims, within.plus(t).times(f32x4::splat(step)));
        Some((value, slope.times(f32x4::splat(step))))
    }

    /// Interpolation in an array of `dims` values.
    #[inline(always)]
    fn at_rows(&self, corners: Voxels, dims: [u32; 3], t: Vectors) -> (f32x4, Vectors) {
        let firsts = corners.linear(dims);
        let [_, y, z, yz] = row_offsets(dims);
        // The last one first: if it is there, so are the others.
        let last = self.pairs(firsts, yz);
        let (first, next, high) = (
            self.pairs(firsts, 0),
            self.pairs(firsts, y),
            self.pairs(firsts, z),
        );
        Eight::of::<T>([first, next, high, last]).interpolated(t)
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

    /// What a sparse store has around the voxel `corner` and its next neighbours.
    #[inline(always)]
    fn around(&self, parts: Parts<'_>, corner: [u32; 3]) -> Around<T::Pair> {
        let [x, y, z] = corner;
        let cell = [x / CELL, y / CELL, z / CELL];
        let local = [
            (x % CELL) as usize,
            (y % CELL) as usize,
            (z % CELL) as usize,
        ];
        let last = CELL as usize - 1;
        let crosses = [local[0] == last, local[1] == last, local[2] == last];
        let in_cell = !(crosses[0] | crosses[1] | crosses[2]);
        let refined = parts.refined(cell);
        // Behind a face lie values of the lattice, up to which this cell reaches.
        if parts.is_plain(cell) || in_cell && refined.is_none() {
            return Around::Coarse(self.lattice(parts, cell), local, 1.0 / CELL as f32);
        }
        if let Some(number) = refined
            && in_cell
        {
            if let Some(rows) = self.all_stored(parts, number, local) {
                return Around::Rows(rows);
            }
            if let Some(octant) = self.octant_alone(parts, number, local) {
                return octant;
            }
        }
        self.by_cells(parts, cell, local, crosses)
    }

    /// Voxels on both sides of a face between cells, or around an edge or a corner; or some stored
    /// and some not. Cell by cell: voxel i of the eight is the next one along the axes of its bits.
    #[inline(always)]
    fn by_cells(
        &self,
        parts: Parts<'_>,
        cell: [u32; 3],
        local: [usize; 3],
        crosses: [bool; 3],
    ) -> Around<T::Pair> {
        let crossed = (0..3).fold(0, |bits, a| bits | usize::from(crosses[a]) << a);
        let mut values = [0.0; 8];
        for bits in (0..8_usize).filter(|bits| bits & !crossed == 0) {
            let (mut its_cell, mut first) = (cell, local);
            for a in 0..3 {
                if bits >> a & 1 == 1 {
                    its_cell[a] += 1;
                    first[a] = 0;
                }
            }
            let refined = parts.refined(its_cell);
            let (rows, size) = match refined {
                None => (self.lattice(parts, its_cell), CELL as usize),
                Some(number) => {
                    let half = CELL as usize / 2;
                    let [x, y, z] = first.map(|l| l / half);
                    (self.octant(parts, number, [x, y, z]), half)
                }
            };
            let interpolated = between::<T>(rows, first.map(|l| l % size), crosses, size);
            for i in (0..8).filter(|i| i & crossed == bits) {
                let step = |a: usize| i >> a & 1 & usize::from(!crosses[a]);
                let at = [first[0] + step(0), first[1] + step(1), first[2] + step(2)];
                let stored = refined.and_then(|number| parts.brick(number, at));
                values[i] = stored.map_or(interpolated[i], |index| self.get(index));
            }
        }
        Around::Mixed(values)
    }

    /// The eight values from a voxel of a refined cell on, if all are stored.
    #[inline(always)]
    fn all_stored(
        &self,
        parts: Parts<'_>,
        number: usize,
        [x, y, z]: [usize; 3],
    ) -> Option<[T::Pair; 4]> {
        let cell = parts.cells[number];
        // Bricks next to each other along x are so among those stored.
        let pair = 1_u64 << (x / 2) | 1_u64 << x.div_ceil(2);
        let mut rows = [T::Pair::zeroed(); 4];
        for (i, row) in rows.iter_mut().enumerate() {
            let (y, z) = (y + (i & 1), z + (i >> 1));
            let bricks = ((z / 2) * 4 + y / 2) * 4;
            if cell.bricks >> bricks & pair != pair {
                return None;
            }
            let before = (cell.bricks & ((1 << (bricks + x / 2)) - 1)).count_ones();
            let first = parts.bricks + (cell.first + before) as usize * BRICK_VALUES;
            let within = first + ((z % 2) * 2 + y % 2) * 2 + x % 2;
            // The next one in this brick, or the first one of the same row in the next.
            let next = if x % 2 == 0 { 1 } else { BRICK_VALUES - 1 };
            *row = T::pair_of(self.values[within], self.values[within + next]);
        }
        Some(rows)
    }

    /// The octant of a refined cell a voxel lies in, if its values and those of the next voxels
    /// are interpolated in it.
    #[inline(always)]
    fn octant_alone(
        &self,
        parts: Parts<'_>,
        number: usize,
        local: [usize; 3],
    ) -> Option<Around<T::Pair>> {
        let [x, y, z] = local;
        let along = |l: usize| 1_u64 << (l / 2) | 1_u64 << l.div_ceil(2);
        // Spread over rows of 4 bricks, and planes of 16.
        let rows = |l: usize| {
            along(l) & 1 | (along(l) & 2) << 3 | (along(l) & 4) << 6 | (along(l) & 8) << 9
        };
        let planes = |l: usize| {
            along(l) & 1 | (along(l) & 2) << 15 | (along(l) & 4) << 30 | (along(l) & 8) << 45
        };
        // No carries: each product puts copies of one pattern side by side.
        let bricks = along(x) * rows(y) * planes(z);
        if parts.cells[number].bricks & bricks != 0 {
            return None;
        }
        let octant = [x / 4, y / 4, z / 4];
        let within = [x % 4, y % 4, z % 4];
        Some(Around::Coarse(
            self.octant(parts, number, octant),
            within,
            0.25,
        ))
    }

    /// The value of a voxel in a cell, given the cell's number among the refined ones.
    #[inline(always)]
    fn value_in(
        &self,
        parts: Parts<'_>,
        cell: [u32; 3],
        refined: Option<usize>,
        local: [usize; 3],
    ) -> f32 {
        let [x, y, z] = local;
        let Some(number) = refined else {
            let t = Vec3::new(x as f32, y as f32, z as f32) / CELL as f32;
            return at::<T>(self.lattice(parts, cell), t);
        };
        if let Some(index) = parts.brick(number, local) {
            return self.get(index);
        }
        let t = Vec3::new((x % 4) as f32, (y % 4) as f32, (z % 4) as f32) / 4.0;
        at::<T>(self.octant(parts, number, [x / 4, y / 4, z / 4]), t)
    }

    /// The corners of an octant of a refined cell.
    #[inline(always)]
    fn octant(&self, parts: Parts<'_>, number: usize, [x, y, z]: [usize; 3]) -> [T::Pair; 4] {
        let first = parts.middles + number * MIDDLE_VALUES + (z * 3 + y) * 3 + x;
        let row = |offset| self.pair(first + offset);
        [row(0), row(3), row(9), row(12)]
    }

    /// The corners of a cell in the lattice of all cells.
    #[inline(always)]
    fn lattice(&self, parts: Parts<'_>, cell: [u32; 3]) -> [T::Pair; 4] {
        let dims = lattice_dims(parts.cell_dims);
        let first = linear(dims, cell);
        let [a, b, c, d] = row_offsets(dims);
        let row = |offset| self.pair(first + offset);
        [row(a), row(b), row(c), row(d)]
    }
}

/// What lies around a point of a sparse store, in rows of two values: x fastest, then y, then z.
enum Around<P> {
    /// The values of the eight voxels.
    Rows([P; 4]),
    /// Values further apart; which voxel from the first of them on; and a voxel's part of their
    /// distance.
    Coarse([P; 4], [usize; 3], f32),
    /// The values of the eight voxels, of which some are interpolated.
    Mixed([f32; 8]),
}
