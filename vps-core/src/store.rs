//! Where the values of a [`Voxelmap`](crate::Voxelmap) lie.

use bytemuck::{Pod, Zeroable};
use glamx::Vec3;

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
fn product(dims: [u32; 3]) -> usize {
    dims.iter()
        .fold(1, |count: usize, &n| count.saturating_mul(n as usize))
}

impl<'a> Store<'a> {
    /// A value for each of `dims` voxels.
    ///
    /// # Errors
    /// When there are more or fewer, or one is not finite.
    pub fn dense(dims: [u32; 3], values: Values<'a>) -> Result<Self, VoxelmapError> {
        Self {
            dims,
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
            if group.before as usize != refined || group.refined & beyond != 0 {
                return Err(VoxelmapError::Cells);
            }
            refined += group.refined.count_ones() as usize;
        }
        if cells.len() != refined {
            return Err(VoxelmapError::Cells);
        }
        let mut stored = 0_usize;
        for cell in cells.iter() {
            if cell.first as usize != stored {
                return Err(VoxelmapError::Cells);
            }
            stored += cell.bricks.count_ones() as usize;
        }
        let middles = product(cell_dims.map(|n| n + 1));
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
            values,
            layout,
        }
        .checked(bricks + stored * BRICK_VALUES)
    }

    fn checked(self, expected: usize) -> Result<Self, VoxelmapError> {
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

    /// Voxels along x, y and z.
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
    pub fn value(&self, voxel: [u32; 3]) -> f32 {
        match &self.values {
            Values::Integers(values) => self.read(values).value(voxel),
            Values::Floats(values) => self.read(values).value(voxel),
        }
    }

    /// The values of the voxel `corner` and its next neighbours along each axis, interpolated at
    /// `t`, between 0 and 1. The neighbours must be in the grid, or `t` be 0 towards them.
    pub(crate) fn interpolated(&self, corner: [u32; 3], t: Vec3) -> f32 {
        match &self.values {
            Values::Integers(values) => self.read(values).interpolated(corner, t),
            Values::Floats(values) => self.read(values).interpolated(corner, t),
        }
    }

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

impl<T: Copy + Into<f32>> Reader<'_, T> {
    fn get(&self, index: usize) -> f32 {
        self.values[index].into()
    }

    fn value(&self, voxel: [u32; 3]) -> f32 {
        match self.layout {
            Layout::Dense => self.get(linear(self.dims, voxel)),
            Layout::Sparse(sparse) => {
                let parts = sparse.parts();
                let cell = voxel.map(|c| c / CELL);
                self.value_in(parts, cell, parts.refined(cell), voxel)
            }
        }
    }

    fn interpolated(&self, corner: [u32; 3], t: Vec3) -> f32 {
        let next = [0, 1, 2].map(|a| (corner[a] + 1).min(self.dims[a] - 1));
        let at = |i: usize| {
            let pick = |a: usize| if i >> a & 1 == 1 { next[a] } else { corner[a] };
            [pick(0), pick(1), pick(2)]
        };
        let Layout::Sparse(sparse) = self.layout else {
            let value = |i| self.get(linear(self.dims, at(i)));
            return lerp_eight(core::array::from_fn(value), t);
        };
        let parts = sparse.parts();
        let cell = corner.map(|c| c / CELL);
        let refined = parts.refined(cell);
        let last = next.map(|c| c / CELL);
        if last == cell {
            let Some(number) = refined else {
                // Trilinear between the voxels of a trilinear cell: the cell's own function.
                let local = Vec3::from_array(corner.map(|c| (c % CELL) as f32)) + t;
                return self.coarse(parts, cell, local / CELL as f32);
            };
            if let Some(values) = self.eight_stored(parts, number, corner, next) {
                return lerp_eight(values, t);
            }
            if let Some(value) = self.in_octant(parts, number, corner, next, t) {
                return value;
            }
            let value = |i| self.value_in(parts, cell, refined, at(i));
            return lerp_eight(core::array::from_fn(value), t);
        }
        // Voxels on both sides of a face between cells, or around an edge or a corner.
        let mut known = (cell, refined);
        let mut found = (last, parts.refined(last));
        let value = |i| {
            let voxel = at(i);
            let its_cell = voxel.map(|c| c / CELL);
            if its_cell != known.0 {
                core::mem::swap(&mut known, &mut found);
                if its_cell != known.0 {
                    known = (its_cell, parts.refined(its_cell));
                }
            }
            self.value_in(parts, its_cell, known.1, voxel)
        };
        lerp_eight(core::array::from_fn(value), t)
    }

    /// The eight values between two voxels of a refined cell, if all are stored.
    #[inline]
    fn eight_stored(
        &self,
        parts: Parts<'_>,
        number: usize,
        low: [u32; 3],
        high: [u32; 3],
    ) -> Option<[f32; 8]> {
        let cell = parts.cells[number];
        let [x, y, z] = low.map(|c| (c % CELL) as usize);
        let [x1, y1, z1] = high.map(|c| (c % CELL) as usize);
        // Bricks next to each other along x are so among those stored.
        let pair = 1_u64 << (x / 2) | 1_u64 << (x1 / 2);
        let mut values = [0.0; 8];
        for (i, (y, z)) in [(y, z), (y1, z), (y, z1), (y1, z1)].into_iter().enumerate() {
            let row = ((z / 2) * 4 + y / 2) * 4;
            if cell.bricks >> row & pair != pair {
                return None;
            }
            let before = (cell.bricks & ((1 << (row + x / 2)) - 1)).count_ones();
            let first = parts.bricks + (cell.first + before) as usize * BRICK_VALUES;
            let within = first + ((z % 2) * 2 + y % 2) * 2;
            values[2 * i] = self.get(within + x % 2);
            values[2 * i + 1] = self.get(within + (x1 / 2 - x / 2) * BRICK_VALUES + x1 % 2);
        }
        Some(values)
    }

    /// The value of a voxel in a cell, given the cell's number among the refined ones.
    #[inline]
    fn value_in(
        &self,
        parts: Parts<'_>,
        cell: [u32; 3],
        refined: Option<usize>,
        voxel: [u32; 3],
    ) -> f32 {
        let local = voxel.map(|c| c % CELL);
        let Some(refined) = refined else {
            let t = Vec3::from_array(local.map(|c| c as f32)) / CELL as f32;
            return self.coarse(parts, cell, t);
        };
        let cell = parts.cells[refined];
        let [x, y, z] = local.map(|c| c as usize);
        let bit = 1_u64 << (((z / 2) * 4 + y / 2) * 4 + x / 2);
        if cell.bricks & bit != 0 {
            let before = (cell.bricks & (bit - 1)).count_ones();
            let brick = (cell.first + before) as usize;
            let within = ((z % 2) * 2 + y % 2) * 2 + x % 2;
            return self.get(parts.bricks + brick * BRICK_VALUES + within);
        }
        let t = Vec3::from_array(local.map(|c| (c % 4) as f32)) / 4.0;
        self.middle(parts, refined, [x / 4, y / 4, z / 4], t)
    }

    /// An octant of a refined cell, interpolated at `t`.
    #[inline]
    fn middle(&self, parts: Parts<'_>, number: usize, [x, y, z]: [usize; 3], t: Vec3) -> f32 {
        let first = parts.middles + number * MIDDLE_VALUES + (z * 3 + y) * 3 + x;
        let at = |i: usize| self.get(first + (i & 1) + (i >> 1 & 1) * 3 + (i >> 2) * 9);
        lerp_eight(core::array::from_fn(at), t)
    }

    /// Between two voxels of a refined cell none of whose bricks are stored, and which lie in one
    /// octant: the octant's own function.
    #[inline]
    fn in_octant(
        &self,
        parts: Parts<'_>,
        number: usize,
        low: [u32; 3],
        high: [u32; 3],
        t: Vec3,
    ) -> Option<f32> {
        let octant = low.map(|c| c % CELL / 4);
        if high.map(|c| c % CELL / 4) != octant {
            return None;
        }
        let [x, y, z] = octant.map(|c| c as usize);
        // The 2 x 2 x 2 bricks of an octant.
        let bricks = 0x0033_0033_u64 << ((z * 8 + y * 2) * 4 + x * 2);
        if parts.cells[number].bricks & bricks != 0 {
            return None;
        }
        let local = Vec3::from_array(low.map(|c| (c % 4) as f32)) + t;
        Some(self.middle(parts, number, [x, y, z], local / 4.0))
    }

    /// The lattice of all cells, interpolated at `t` in one of them.
    fn coarse(&self, parts: Parts<'_>, cell: [u32; 3], t: Vec3) -> f32 {
        let [nx, ny, _] = parts.cell_dims.map(|n| n as usize + 1);
        let first = linear(parts.cell_dims.map(|n| n + 1), cell);
        let at = |i: usize| {
            let (dx, dy, dz) = (i & 1, i >> 1 & 1, i >> 2);
            self.get(first + (dz * ny + dy) * nx + dx)
        };
        lerp_eight(core::array::from_fn(at), t)
    }
}

impl Sparse<'_> {
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
    /// The number of a cell among the refined ones, if it is one of them.
    #[inline]
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
    let [nx, ny, _] = dims.map(|n| n as usize);
    let [x, y, z] = at.map(|c| c as usize);
    (z * ny + y) * nx + x
}

/// Trilinear interpolation between eight corners, x fastest.
fn lerp_eight(corners: [f32; 8], t: Vec3) -> f32 {
    let lerp = |a: f32, b: f32, t: f32| a + (b - a) * t;
    let row = |i: usize| lerp(corners[i], corners[i + 1], t.x);
    let plane = |i: usize| lerp(row(i), row(i + 2), t.y);
    lerp(plane(0), plane(4), t.z)
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
        let groups = vec![CellGroup {
            refined: 0b10_0010,
            ..CellGroup::default()
        }];
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
                        let [a, b] = [&sparse, &dense].map(|s| s.interpolated([x, y, z], t));
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
        let group = |refined, before| CellGroup {
            refined,
            before,
            reserved: 0,
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
