//! Where the values of a [`Voxelmap`](crate::Voxelmap) lie.

use bytemuck::{Pod, Zeroable};
use glamx::Vec3;
use wide::{f32x4, i32x4};

use crate::lanes::{LANES, Points, Vectors, Voxels};
use crate::{Storage, VoxelmapError};

/// Voxels along the edge of a cell of a sparse [`Store`].
pub const CELL: u32 = 8;

/// Values a refined cell has of its own: 3 along each edge, 4 voxels apart.
pub const MIDDLE_VALUES: usize = 27;

/// Voxels in a brick: 2 along each edge.
pub const BRICK_VALUES: usize = 8;

/// The numbers in a [`Store`].
#[derive(Clone, Debug)]
pub enum Values<'a> {
    /// 16-bit integers: layers, or distances in steps of λ (eq. 1).
    Integers(Storage<'a, i16>),
    /// 32-bit floating-point distances in metres.
    Floats(Storage<'a, f32>),
}

impl Values<'_> {
    /// How many there are.
    pub fn len(&self) -> usize {
        match self {
            Self::Integers(values) => values.len(),
            Self::Floats(values) => values.len(),
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The values as bytes in the machine's order.
    pub fn bytes(&self) -> &[u8] {
        match self {
            Self::Integers(values) => bytemuck::cast_slice(values),
            Self::Floats(values) => bytemuck::cast_slice(values),
        }
    }

    #[cfg(feature = "alloc")]
    fn into_owned(self) -> Values<'static> {
        match self {
            Self::Integers(values) => Values::Integers(values.into_owned()),
            Self::Floats(values) => Values::Floats(values.into_owned()),
        }
    }
}

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

/// One value for every voxel of a grid, stored or interpolated.
///
/// A dense store holds them all, x fastest, then y, then z. A sparse one has two levels:
///
/// * The grid is cut into cells of 8 x 8 x 8 voxels. A lattice of values, one at the first voxel
///   of every cell and one behind the last along each axis, holds for all voxels by trilinear
///   interpolation.
/// * Where that is not good enough a cell is refined: it has 3 x 3 x 3 values of its own, 4 voxels
///   apart, between which its voxels are interpolated; and where that is not good enough either,
///   close to the surface above all, the 8 values of a brick of 2 x 2 x 2 voxels are stored as
///   they are.
///
/// The values of the lattice come first, then those of the refined cells, then the bricks. What
/// is good enough, the builder decides, and states it in [`Accuracy`](crate::Accuracy).
#[derive(Clone, Debug)]
pub struct Store<'a> {
    dims: [u32; 3],
    cell_dims: [u32; 3],
    values: Values<'a>,
    layout: Layout<'a>,
}

#[derive(Clone, Debug)]
enum Layout<'a> {
    Dense,
    Sparse(Sparse<'a>),
}

#[derive(Clone, Debug)]
struct Sparse<'a> {
    groups: Storage<'a, CellGroup>,
    cells: Storage<'a, RefinedCell>,
    cell_dims: [u32; 3],
    /// Where the values of refined cells start, and those of bricks.
    middles: usize,
    bricks: usize,
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
fn for_each_cell(dims: [u32; 3], mut visit: impl FnMut([u32; 3], usize)) {
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
fn is_plain(dims: [u32; 3], groups: &[CellGroup], cell: [u32; 3]) -> bool {
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

impl<'a> Store<'a> {
    /// A value for each of `dims` voxels.
    ///
    /// # Errors
    /// When there are more or fewer, or one is not finite.
    pub fn dense(dims: [u32; 3], values: Values<'a>) -> Result<Self, VoxelmapError> {
        Self {
            dims,
            cell_dims: cell_dims(dims),
            values,
            layout: Layout::Dense,
        }
        .checked(product(dims))
    }

    /// Values for a grid of `dims` voxels where `groups` and `cells` say that they are.
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
            let bits = group.refined | group.plain;
            if group.before as usize != refined || bits & beyond != 0 {
                return Err(VoxelmapError::Cells);
            }
            refined += group.refined.count_ones() as usize;
        }
        let mut marked = true;
        for_each_cell(dims, |cell, index| {
            marked &= is_set(groups[index / 64].plain, index) == is_plain(dims, &groups, cell);
        });
        if cells.len() != refined || !marked {
            return Err(VoxelmapError::Cells);
        }
        let mut stored = 0_usize;
        for cell in cells.iter() {
            if cell.first as usize != stored {
                return Err(VoxelmapError::Cells);
            }
            stored += cell.bricks.count_ones() as usize;
        }
        let middles = product(lattice_dims(cell_dims));
        let bricks = middles + refined * MIDDLE_VALUES;
        let layout = Layout::Sparse(Sparse {
            groups,
            cells,
            cell_dims,
            middles,
            bricks,
        });
        Self {
            dims,
            cell_dims,
            values,
            layout,
        }
        .checked(bricks + stored * BRICK_VALUES)
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

    /// Cells of 8 x 8 x 8 voxels along x, y and z.
    #[inline]
    pub(crate) fn cell_dims(&self) -> [u32; 3] {
        self.cell_dims
    }

    /// Voxels along x, y and z.
    #[inline]
    pub fn dims(&self) -> [u32; 3] {
        self.dims
    }

    /// The numbers, in the order of the store.
    pub fn values(&self) -> &Values<'a> {
        &self.values
    }

    /// Which cells are refined, and what they hold; both are empty for a dense store.
    pub fn cells(&self) -> (&[CellGroup], &[RefinedCell]) {
        match &self.layout {
            Layout::Dense => (&[], &[]),
            Layout::Sparse(sparse) => (&sparse.groups, &sparse.cells),
        }
    }

    /// Whether all values are stored.
    pub fn is_dense(&self) -> bool {
        matches!(self.layout, Layout::Dense)
    }

    /// What the store takes in memory, and in a file but for its alignment.
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

    /// What lies between the voxels `corners` and their next neighbours along each axis at `t`,
    /// between 0 and 1, and how much it grows per voxel there.
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
                Layout::Sparse(sparse) => Layout::Sparse(Sparse {
                    groups: sparse.groups.into_owned(),
                    cells: sparse.cells.into_owned(),
                    ..sparse
                }),
            },
        }
    }
}

/// A store whose values are known to be of one kind.
#[derive(Clone, Copy)]
struct Reader<'r, T> {
    dims: [u32; 3],
    layout: &'r Layout<'r>,
    values: &'r [T],
}

/// The parts of a sparse store.
#[derive(Clone, Copy)]
struct Parts<'r> {
    groups: &'r [CellGroup],
    cells: &'r [RefinedCell],
    cell_dims: [u32; 3],
    middles: usize,
    bricks: usize,
}

impl<T: Value> Reader<'_, T> {
    #[inline(always)]
    fn get(&self, index: usize) -> f32 {
        self.values[index].into()
    }

    fn value(&self, voxel: [u32; 3]) -> f32 {
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
    fn interpolated(&self, corners: Voxels, t: Vectors) -> (f32x4, Vectors) {
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

/// A number in a [`Store`].
trait Value: Pod + Into<f32> {
    /// Two that lie next to each other.
    type Pair: Pod;

    fn pair(values: &[Self], first: usize) -> Self::Pair;

    fn pair_of(first: Self, second: Self) -> Self::Pair;

    /// The first ones of all pairs, and the second ones.
    fn unzip(pairs: [Self::Pair; LANES]) -> [f32x4; 2];
}

impl Value for i16 {
    /// Both at once, as they lie in memory.
    type Pair = i32;

    #[inline(always)]
    fn pair(values: &[Self], first: usize) -> i32 {
        // As a whole: of two loads the compiler makes worse.
        let mut pair = [0_i16; 2];
        pair.copy_from_slice(&values[first..first + 2]);
        let both: i32 = bytemuck::cast(pair);
        if cfg!(target_endian = "big") {
            both.rotate_left(16)
        } else {
            both
        }
    }

    #[inline(always)]
    fn pair_of(first: Self, second: Self) -> i32 {
        i32::from(second) << 16 | i32::from(first) & 0xffff
    }

    #[inline(always)]
    fn unzip([a, b, c, d]: [i32; LANES]) -> [f32x4; 2] {
        let both = i32x4::new([a, b, c, d]);
        let low: i32x4 = (both << 16) >> 16;
        let high: i32x4 = both >> 16;
        [low.round_float(), high.round_float()]
    }
}

impl Value for f32 {
    type Pair = [f32; 2];

    #[inline(always)]
    fn pair(values: &[Self], first: usize) -> [f32; 2] {
        let pair = &values[first..first + 2];
        [pair[0], pair[1]]
    }

    #[inline(always)]
    fn pair_of(first: f32, second: f32) -> [f32; 2] {
        [first, second]
    }

    #[inline(always)]
    fn unzip([a, b, c, d]: [[f32; 2]; LANES]) -> [f32x4; 2] {
        [
            f32x4::new([a[0], b[0], c[0], d[0]]),
            f32x4::new([a[1], b[1], c[1], d[1]]),
        ]
    }
}

/// Eight values in each lane, x fastest, then y, then z.
struct Eight([f32x4; 8]);

impl Eight {
    /// Of rows along x, the pairs of all lanes in each.
    #[inline(always)]
    fn of<T: Value>([low, next, high, last]: [[T::Pair; LANES]; 4]) -> Self {
        let ([a, b], [c, d]) = (T::unzip(low), T::unzip(next));
        let ([e, f], [g, h]) = (T::unzip(high), T::unzip(last));
        Self([a, b, c, d, e, f, g, h])
    }

    /// The same values in all lanes.
    #[inline(always)]
    fn splat<T: Value>([a, b, c, d]: [T::Pair; 4]) -> Self {
        Self::of::<T>([[a; LANES], [b; LANES], [c; LANES], [d; LANES]])
    }

    #[inline(always)]
    fn set(&mut self, lane: usize, values: [f32; 8]) {
        for (own, value) in self.0.iter_mut().zip(values) {
            own.as_mut_array()[lane] = value;
        }
    }

    /// Trilinear interpolation, and how much it grows per step along each axis.
    #[inline(always)]
    fn interpolated(&self, t: Vectors) -> (f32x4, Vectors) {
        let lerp = |a: f32x4, b: f32x4, t: f32x4| a + (b - a) * t;
        let [a, b, c, d, e, f, g, h] = self.0;
        // Slopes along x in the four rows, and the rows at t.
        let steps = [b - a, d - c, f - e, h - g];
        let rows = [
            a + steps[0] * t.x,
            c + steps[1] * t.x,
            e + steps[2] * t.x,
            g + steps[3] * t.x,
        ];
        let (low, high) = (lerp(rows[0], rows[1], t.y), lerp(rows[2], rows[3], t.y));
        let slope = Vectors {
            x: lerp(
                lerp(steps[0], steps[1], t.y),
                lerp(steps[2], steps[3], t.y),
                t.z,
            ),
            y: lerp(rows[1] - rows[0], rows[3] - rows[2], t.z),
            z: high - low,
        };
        (lerp(low, high, t.z), slope)
    }
}

impl Sparse<'_> {
    #[inline]
    fn parts(&self) -> Parts<'_> {
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
    fn brick(&self, number: usize, [x, y, z]: [usize; 3]) -> Option<usize> {
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
    fn is_plain(&self, cell: [u32; 3]) -> bool {
        let index = linear(self.cell_dims, cell);
        is_set(self.groups[index / 64].plain, index)
    }

    /// The number of a cell among the refined ones, if it is one of them.
    #[inline(always)]
    fn refined(&self, cell: [u32; 3]) -> Option<usize> {
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

/// Position in an array with x fastest, then y, then z.
#[inline]
fn linear(dims: [u32; 3], at: [u32; 3]) -> usize {
    let [nx, ny] = [dims[0] as usize, dims[1] as usize];
    (at[2] as usize * ny + at[1] as usize) * nx + at[0] as usize
}

/// How far the four rows around a place lie from the first.
#[inline(always)]
fn row_offsets([nx, ny, _]: [u32; 3]) -> [usize; 4] {
    // The product in 32 bits, so that positions are known not to overflow.
    let (row, plane) = (nx as usize, nx.wrapping_mul(ny) as usize);
    [0, row, plane, plane + row]
}

/// The lattice has a value at the first voxel of each cell and one behind the last.
#[inline(always)]
fn lattice_dims([nx, ny, nz]: [u32; 3]) -> [u32; 3] {
    [nx + 1, ny + 1, nz + 1]
}

/// Whether the bit of a cell is set in its group.
#[inline(always)]
fn is_set(bits: u64, cell: usize) -> bool {
    bits >> (cell % 64) & 1 == 1
}

/// What the values at the corners of a cube of `size` voxels make of one of them and of the next
/// ones, but for those behind faces that are crossed.
#[inline(always)]
fn between<T: Value>(
    corners: [T::Pair; 4],
    first: [usize; 3],
    crosses: [bool; 3],
    size: usize,
) -> [f32; 8] {
    let t = |axis: usize, next: [f32; LANES]| {
        let next = if crosses[axis] { [0.0; LANES] } else { next };
        (f32x4::new(next) + first[axis] as f32) / size as f32
    };
    let corners = Eight::splat::<T>(corners);
    let plane = |next: f32| {
        let t = Vectors {
            x: t(0, [0.0, 1.0, 0.0, 1.0]),
            y: t(1, [0.0, 0.0, 1.0, 1.0]),
            z: t(2, [next; LANES]),
        };
        corners.interpolated(t).0
    };
    bytemuck::cast([plane(0.0), plane(1.0)])
}

/// What the values at the corners of a cube make of a single point.
#[inline(always)]
fn at<T: Value>(corners: [T::Pair; 4], t: Vec3) -> f32 {
    let (value, _) = Eight::splat::<T>(corners).interpolated(Vectors::splat(t));
    value.to_array()[0]
}

#[cfg(test)]
mod tests {
    use std::vec;
    use std::vec::Vec;

    use super::*;

    const DIMS: [u32; 3] = [17, 9, 8];

    /// Three by two by one cells; the second and the last are refined, and in the latter two
    /// bricks are stored.
    fn store(values: Vec<i16>) -> Result<Store<'static>, VoxelmapError> {
        let mut groups = vec![CellGroup {
            refined: 0b10_0010,
            ..CellGroup::default()
        }];
        mark_plain(DIMS, &mut groups);
        assert_eq!(groups[0].plain, 0b001000);
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
    fn each_voxel_finds_its_value() {
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

    /// The short ways of interpolation against eight values of their own.
    #[test]
    fn interpolation_is_that_of_the_eight_values() {
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
    fn parts_that_do_not_fit_are_refused() {
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
        let group = |refined, before| {
            let mut group = [CellGroup {
                refined,
                before,
                ..CellGroup::default()
            }];
            mark_plain(DIMS, &mut group);
            group[0]
        };
        let cell = |bricks, first| RefinedCell {
            bricks,
            first,
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
