//! The sparse store of a voxelmap: which voxels may be interpolated, and proof of it.

use glamx::DVec3;
use rayon::prelude::*;
use vps_core::store::{
    BRICK_VALUES, CELL, CellGroup, MIDDLE_VALUES, RefinedCell, cell_dims, mark_plain,
};
use vps_core::{Grid, Store, Values, VoxelmapError};

use crate::distance::Exact;

/// Where the penetrations of voxels come from, in metres.
pub(crate) enum Source<'a> {
    /// From the mesh, voxel by voxel. Here a few of them prove something about those between.
    Exact(&'a Exact<'a>),
    /// From a table of all voxels.
    Table(&'a [f32]),
}

/// How penetrations become values of a store.
#[derive(Clone, Copy)]
pub(crate) enum Coding {
    /// Integers of so many metres each, truncated towards zero (eq. 1).
    Integers(f64),
    /// Layers of so many metres each, rounded: they are whole but for the rounding of metres.
    Layers(f64),
    Floats,
}

impl Coding {
    /// The value for a penetration, as it is stored.
    fn value(self, penetration: f64) -> f32 {
        match self {
            Self::Integers(sigma) => (penetration / sigma) as i16 as f32,
            Self::Layers(size) => (penetration / size).round() as i16 as f32,
            Self::Floats => penetration as f32,
        }
    }

    /// What a value is worth in metres.
    pub(crate) fn sigma(self) -> f64 {
        match self {
            Self::Integers(sigma) | Self::Layers(sigma) => sigma,
            Self::Floats => 1.0,
        }
    }

    pub(crate) fn values(self, values: Vec<f32>) -> Values<'static> {
        match self {
            Self::Integers(_) | Self::Layers(_) => {
                Values::Integers(values.iter().map(|&v| v as i16).collect::<Vec<_>>().into())
            }
            Self::Floats => Values::Floats(values.into()),
        }
    }

    /// Values of all voxels, for a dense store.
    pub(crate) fn all(self, penetrations: &[f32]) -> Values<'static> {
        let values = penetrations.par_iter();
        self.values(values.map(|&p| self.value(f64::from(p))).collect())
    }
}

/// What an interpolated voxel must keep to, in metres.
#[derive(Clone, Copy)]
pub(crate) struct Tolerance {
    /// How far it may be from the exact penetration.
    pub(crate) error: f64,
    /// What is closer to the surface than this, before or after interpolation, must be as good as if
    /// it were stored:
    pub(crate) band: f64,
    /// no further from the exact penetration than this.
    pub(crate) near: f64,
}

/// A voxel's penetration in metres, and the closest point of the mesh if it is known.
type Sample = (f64, Option<DVec3>);

/// The values of the lattice of cells.
pub(crate) struct Lattice {
    dims: [u32; 3],
    samples: Vec<Sample>,
}

impl Source<'_> {
    fn at(&self, grid: &Grid, voxel: [u32; 3], guess: &mut u32) -> Sample {
        match self {
            Self::Exact(exact) => {
                let (penetration, closest) = exact.at(voxel, guess);
                (penetration, Some(closest))
            }
            Self::Table(table) => {
                let dims = grid.dims();
                let inside = [0, 1, 2].map(|a| voxel[a].min(dims[a] - 1));
                (f64::from(table[grid.index(inside)]), None)
            }
        }
    }

    /// Penetrations at the corners of all cells.
    pub(crate) fn lattice(&self, grid: &Grid) -> Lattice {
        let dims = cell_dims(grid.dims()).map(|n| n + 1);
        let [nx, ny, nz] = dims;
        let rows: Vec<_> = (0..nz).flat_map(|z| (0..ny).map(move |y| (y, z))).collect();
        let row = |&(y, z): &(u32, u32)| {
            let mut guess = 0;
            let mut at = |x| self.at(grid, [x, y, z].map(|c| c * CELL), &mut guess);
            (0..nx).map(&mut at).collect::<Vec<_>>()
        };
        Lattice {
            dims,
            samples: rows.par_iter().flat_map_iter(row).collect(),
        }
    }
}

impl Lattice {
    /// A bound on the penetration of any voxel, without its sign.
    pub(crate) fn largest(&self, voxel_size: f64) -> f64 {
        let largest = self.samples.iter().fold(0.0, |l: f64, s| l.max(s.0.abs()));
        // Half the diagonal of a cell.
        largest + 0.8661 * f64::from(CELL) * voxel_size
    }

    fn corners(&self, cell: [u32; 3]) -> [Sample; 8] {
        let [nx, ny, _] = self.dims.map(|n| n as usize);
        core::array::from_fn(|i| {
            let at = [0, 1, 2].map(|a| cell[a] as usize + (i >> a & 1));
            self.samples[(at[2] * ny + at[1]) * nx + at[0]]
        })
    }
}

/// A store of the source's penetrations, within the tolerance.
pub(crate) fn sparse(
    grid: &Grid,
    source: &Source<'_>,
    lattice: &Lattice,
    coding: Coding,
    tolerance: Tolerance,
) -> Result<Store<'static>, VoxelmapError> {
    let [nx, ny, nz] = cell_dims(grid.dims());
    let cells: Vec<_> = (0..nz)
        .flat_map(|z| (0..ny).flat_map(move |y| (0..nx).map(move |x| [x, y, z])))
        .collect();
    let refined: Vec<Option<Refined>> = cells
        .par_iter()
        .map_init(
            || Cell::new(grid, source, coding, tolerance),
            |cell, &at| cell.refine(at, lattice.corners(at)),
        )
        .collect();
    let stored = |sample: &Sample| coding.value(sample.0);
    let mut values: Vec<f32> = lattice.samples.iter().map(stored).collect();
    values.extend(refined.iter().flatten().flat_map(|cell| cell.middle));
    let mut groups = Vec::new();
    let mut cells = Vec::new();
    let mut first = 0;
    for sixty_four in refined.chunks(64) {
        let mut group = CellGroup {
            before: cells.len() as u32,
            ..CellGroup::default()
        };
        for (i, cell) in sixty_four.iter().enumerate() {
            let Some(cell) = cell else { continue };
            group.refined |= 1 << i;
            cells.push(RefinedCell {
                bricks: cell.bricks,
                first,
                reserved: 0,
            });
            first += cell.bricks.count_ones();
            values.extend(&cell.values);
        }
        groups.push(group);
    }
    mark_plain(grid.dims(), &mut groups);
    let values = coding.values(values);
    Store::sparse(grid.dims(), groups.into(), cells.into(), values)
}

/// What a refined cell holds.
struct Refined {
    middle: [f32; MIDDLE_VALUES],
    bricks: u64,
    values: Vec<f32>,
}

/// Samples of a cell along each edge, those of the next cells included.
const SIDE: usize = CELL as usize + 1;

/// A cell while it is decided on.
struct Cell<'a> {
    grid: &'a Grid,
    source: &'a Source<'a>,
    coding: Coding,
    tolerance: Tolerance,
    /// Its first voxel.
    first: [u32; 3],
    /// What has been asked of the source.
    samples: Vec<Option<Sample>>,
    /// Where in `samples` something is.
    asked: Vec<usize>,
    /// The last triangle found.
    guess: u32,
}

/// A function that is trilinear between the corners of a cube of voxels.
#[derive(Clone, Copy)]
struct Cube {
    first: [u32; 3],
    size: u32,
    /// Its values at the corners in metres.
    corners: [f64; 8],
}

impl Cube {
    fn at(&self, [x, y, z]: [u32; 3]) -> f64 {
        let t = |c: u32, first: u32| f64::from(c - first) / f64::from(self.size);
        let lerp = |a: f64, b: f64, t: f64| a + (b - a) * t;
        let [tx, ty, tz] = [
            t(x, self.first[0]),
            t(y, self.first[1]),
            t(z, self.first[2]),
        ];
        let row = |i: usize| lerp(self.corners[i], self.corners[i + 1], tx);
        let plane = |i: usize| lerp(row(i), row(i + 2), ty);
        lerp(plane(0), plane(4), tz)
    }
}

/// The i-th corner of a cube, x first.
fn corner(first: [u32; 3], size: u32, i: usize) -> [u32; 3] {
    [0, 1, 2].map(|a| first[a] + size * (i as u32 >> a & 1))
}

/// Where the sample of a voxel is.
fn index(local: [u32; 3]) -> usize {
    let [x, y, z] = local.map(|c| c as usize);
    (z * SIDE + y) * SIDE + x
}

/// The smallest change, without its sign, along the four edges of one axis; 0 if they do not
/// agree on the sign.
fn least_change(corners: &[f64; 8], axis: usize) -> f64 {
    let edges = (0..8).filter(|i| i >> axis & 1 == 0);
    let changes = edges.map(|i| corners[i | 1 << axis] - corners[i]);
    let (least, most) = changes.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), c| {
        (least.min(c), most.max(c))
    });
    least.max(-most).max(0.0)
}

impl<'a> Cell<'a> {
    fn new(grid: &'a Grid, source: &'a Source<'a>, coding: Coding, tolerance: Tolerance) -> Self {
        Self {
            grid,
            source,
            coding,
            tolerance,
            first: [0; 3],
            samples: vec![None; SIDE * SIDE * SIDE],
            asked: Vec::new(),
            guess: 0,
        }
    }

    /// What the cell must hold of its own, if the lattice is not good enough for it.
    fn refine(&mut self, cell: [u32; 3], lattice: [Sample; 8]) -> Option<Refined> {
        self.first = cell.map(|c| c * CELL);
        for i in self.asked.drain(..) {
            self.samples[i] = None;
        }
        for (i, sample) in lattice.into_iter().enumerate() {
            let index = index(corner([0; 3], CELL, i));
            self.samples[index] = Some(sample);
            self.asked.push(index);
        }
        let coarse = self.cube([0; 3], CELL);
        if self.holds(&coarse, [0; 3], CELL) {
            return None;
        }
        let half = CELL / 2;
        let mut middle = [0.0; MIDDLE_VALUES];
        for (i, value) in (0..).zip(&mut middle) {
            let at = [i % 3, i / 3 % 3, i / 9].map(|c| c * half);
            *value = self.coding.value(self.sample(at).0);
        }
        let mut refined = Refined {
            middle,
            bricks: 0,
            values: Vec::new(),
        };
        for i in 0..8 {
            let octant = self.cube(corner([0; 3], half, i), half);
            if !self.holds(&octant, octant.first, half) {
                for i in 0..8 {
                    let first = corner(octant.first, 2, i);
                    if !self.holds(&octant, first, 2) {
                        let [x, y, z] = first.map(|c| c / 2);
                        refined.bricks |= 1 << ((z * 4 + y) * 4 + x);
                    }
                }
            }
        }
        for brick in (0..64_u32).filter(|&i| refined.bricks >> i & 1 == 1) {
            let first = [brick % 4, brick / 4 % 4, brick / 16].map(|c| c * 2);
            for i in 0..BRICK_VALUES {
                let penetration = self.sample(corner(first, 1, i)).0;
                refined.values.push(self.coding.value(penetration));
            }
        }
        Some(refined)
    }

    /// What the stored values at the corners of a cube make of the voxels in it.
    fn cube(&mut self, first: [u32; 3], size: u32) -> Cube {
        let corners = core::array::from_fn(|i| {
            let penetration = self.sample(corner(first, size, i)).0;
            f64::from(self.coding.value(penetration)) * self.coding.sigma()
        });
        Cube {
            first,
            size,
            corners,
        }
    }

    /// Whether the values of a cube are good enough for all voxels of a part of it.
    fn holds(&mut self, cube: &Cube, first: [u32; 3], size: u32) -> bool {
        if size == 1 {
            return self.holds_at(cube, first);
        }
        // Where it fails, it fails in the middle more often than not.
        if !self.holds_at(cube, first.map(|c| c + size / 2)) {
            return false;
        }
        if self.is_proven(cube, first, size) {
            return true;
        }
        let half = size / 2;
        (0..8).all(|i| self.holds(cube, corner(first, half, i), half))
    }

    /// Whether the value of a cube is good enough for a voxel.
    fn holds_at(&mut self, cube: &Cube, voxel: [u32; 3]) -> bool {
        if !self.is_in_grid(voxel) {
            return true;
        }
        let exact = self.sample(voxel).0;
        let given = cube.at(voxel);
        let Tolerance { error, band, near } = self.tolerance;
        let is_far = exact.abs() > band && given.abs() > band;
        (exact - given).abs() <= if is_far { error } else { near }
    }

    /// Whether a few distances prove that the values are good enough.
    ///
    /// Let d be the distance to the mesh, g the given one, x a point of the part, x_i its corners
    /// and w_i their trilinear weights.
    ///
    /// * Squared distances bend no more than those to a point: d(x)² ≥ Σ w_i d_i² − Σ w_i
    ///   |x − x_i|². With t the way through the part along an axis, from 0 to 1, the last sum is
    ///   that of t (1 − t) size² over the axes, and the first exceeds (Σ w_i d_i)² by that of t (1
    ///   − t) m² at least, where m is the smallest change of d along the edges of the axis. So
    ///   d(x)² ≥ (Σ w_i d_i)² − Σ (size² − m²) / 4, and what is given is too large by no more than
    ///   the most it is at a corner and what this makes of the smallest d_i.
    /// * No point of the mesh is closer to x than d(x), and those closest to the corners and to the
    ///   middle are known: d(x) is no more than the least distance to one of them.
    fn is_proven(&mut self, cube: &Cube, first: [u32; 3], size: u32) -> bool {
        let Tolerance { error, band, .. } = self.tolerance;
        let edge = f64::from(size) * f64::from(self.grid.voxel_size());
        let half_diagonal = 0.8661 * edge;
        let (penetration, Some(closest)) = self.sample(first.map(|c| c + size / 2)) else {
            return false;
        };
        if penetration.abs() <= half_diagonal + band {
            return false;
        }
        let sign = penetration.signum();
        let corners: [[u32; 3]; 8] = core::array::from_fn(|i| corner(first, size, i));
        let given = corners.map(|at| cube.at(at) * sign);
        if given.iter().any(|&g| g <= band) {
            return false;
        }
        let samples = corners.map(|at| self.sample(at));
        let exact = samples.map(|(penetration, _)| penetration * sign);
        let nearest = exact.iter().fold(f64::INFINITY, |n, &e| n.min(e));
        if nearest <= half_diagonal {
            return false;
        }
        let flat: f64 = (0..3).map(|axis| least_change(&exact, axis).powi(2)).sum();
        let loss = (0.75 * edge * edge - 0.25 * flat).max(0.0);
        let bend = nearest - (nearest * nearest - loss).sqrt();
        let excess = (0..8).map(|i| given[i] - exact[i]);
        if excess.fold(0.0, f64::max) + bend > error {
            return false;
        }
        // The distance to one point is convex: what holds at all corners holds between them.
        let is_near = |i: usize| self.center(corners[i]).distance(closest) - given[i] <= error;
        if (0..8).all(is_near) {
            return true;
        }
        let at_corners = samples.map(|(_, point)| point.unwrap_or(closest));
        let (low, voxel) = (self.center(first), f64::from(self.grid.voxel_size()));
        let side = size + 1;
        (0..side * side * side).all(|i| {
            let step = [i % side, i / side % side, i / (side * side)];
            let at = low + DVec3::from_array(step.map(f64::from)) * voxel;
            let most = cube.at([0, 1, 2].map(|a| first[a] + step[a])) * sign + error;
            let is_near = |c: &DVec3| c.distance_squared(at) <= most * most;
            // Most often the point of the next corner does.
            let next = (0..3)
                .map(|a| usize::from(2 * step[a] > size) << a)
                .sum::<usize>();
            is_near(&at_corners[next]) || is_near(&closest) || at_corners.iter().any(is_near)
        })
    }

    fn is_in_grid(&self, local: [u32; 3]) -> bool {
        let dims = self.grid.dims();
        (0..3).all(|a| self.first[a] + local[a] < dims[a])
    }

    fn center(&self, local: [u32; 3]) -> DVec3 {
        let voxel = [0, 1, 2].map(|a| self.first[a] + local[a]);
        self.grid.center(voxel).as_dvec3()
    }

    fn sample(&mut self, local: [u32; 3]) -> Sample {
        let index = index(local);
        if let Some(sample) = self.samples[index] {
            return sample;
        }
        let voxel = [0, 1, 2].map(|a| self.first[a] + local[a]);
        let sample = self.source.at(self.grid, voxel, &mut self.guess);
        self.samples[index] = Some(sample);
        self.asked.push(index);
        sample
    }
}
