//! The sparse store of a voxelmap: refines cells where interpolation is not accurate enough.

use glamx::DVec3;
use rayon::prelude::*;
use vps_core::raw::{
    BRICK_VALUES, CELL_EDGE_VOXELS, CellGroup, REFINED_CELL_VALUES, RefinedCell, Store, cell_dims,
    mark_coarse_neighbourhoods,
};
use vps_core::{Grid, VoxelmapError};

use super::lattice::{Lattice, Sample, Source};
use super::quantize::Quantizer;

/// Tolerances of an interpolated voxel, in metres.
#[derive(Clone, Copy)]
pub(crate) struct Tolerance {
    /// Largest error outside of the narrow band.
    pub(crate) beyond_band: f64,
    /// Half-width of the narrow band: distance from the surface, before or after interpolation.
    pub(crate) narrow_band: f64,
    /// Largest error within the narrow band.
    pub(crate) in_band: f64,
}

/// A store of the penetrations within the tolerance.
pub(crate) fn sparse(
    grid: &Grid,
    source: &Source<'_>,
    lattice: &Lattice,
    quantizer: Quantizer,
    tolerance: Tolerance,
) -> Result<Store<'static>, VoxelmapError> {
    let [nx, ny, nz] = cell_dims(grid.dims());
    let cells: Vec<_> = (0..nz)
        .flat_map(|z| (0..ny).flat_map(move |y| (0..nx).map(move |x| [x, y, z])))
        .collect();
    let refined: Vec<Option<RefinedData>> = cells
        .par_iter()
        .map_init(
            || Cell::new(grid, source, quantizer, tolerance),
            |cell, &at| cell.refine(at, lattice.corners(at)),
        )
        .collect();
    let stored = |sample: &Sample| quantizer.quantize(sample.0);
    let mut values: Vec<f32> = lattice.samples.iter().map(stored).collect();
    values.extend(refined.iter().flatten().flat_map(|cell| cell.middle));
    let mut groups = Vec::new();
    let mut cells = Vec::new();
    let mut first_brick = 0;
    for sixty_four in refined.chunks(64) {
        let mut group = CellGroup {
            rank: cells.len() as u32,
            ..CellGroup::default()
        };
        for (i, cell) in sixty_four.iter().enumerate() {
            let Some(cell) = cell else { continue };
            group.refined |= 1 << i;
            cells.push(RefinedCell {
                bricks: cell.bricks,
                first_brick,
                reserved: 0,
            });
            first_brick += cell.bricks.count_ones();
            values.extend(&cell.values);
        }
        groups.push(group);
    }
    mark_coarse_neighbourhoods(grid.dims(), &mut groups);
    let values = quantizer.values(values);
    Store::sparse(grid.dims(), groups.into(), cells.into(), values)
}

/// The values of a refined cell.
struct RefinedData {
    middle: [f32; REFINED_CELL_VALUES],
    bricks: u64,
    values: Vec<f32>,
}

/// Samples along each edge of a cell, including those of the next cell.
const SIDE: usize = CELL_EDGE_VOXELS as usize + 1;

/// A cell during refinement.
struct Cell<'a> {
    grid: &'a Grid,
    source: &'a Source<'a>,
    quantizer: Quantizer,
    tolerance: Tolerance,
    /// Its first voxel.
    first: [u32; 3],
    /// The samples taken so far.
    samples: Vec<Option<Sample>>,
    /// Indices of the samples taken.
    sampled: Vec<usize>,
    /// The closest triangle of the last sample.
    guess: u32,
}

/// A trilinear function over a cube of voxels.
#[derive(Clone, Copy)]
struct TrilinearCube {
    first: [u32; 3],
    size: u32,
    /// Its values at the corners in metres.
    corners: [f64; 8],
}

impl TrilinearCube {
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

/// The i-th corner of a cube, x fastest.
fn corner(first: [u32; 3], size: u32, i: usize) -> [u32; 3] {
    [0, 1, 2].map(|a| first[a] + size * (i as u32 >> a & 1))
}

/// The index of a voxel's sample.
fn index(local: [u32; 3]) -> usize {
    let [x, y, z] = local.map(|c| c as usize);
    (z * SIDE + y) * SIDE + x
}

/// The smallest absolute change along the four edges of one axis; 0 if their signs differ.
fn least_change(corners: &[f64; 8], axis: usize) -> f64 {
    let edges = (0..8).filter(|i| i >> axis & 1 == 0);
    let changes = edges.map(|i| corners[i | 1 << axis] - corners[i]);
    let (least, most) = changes.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), c| {
        (least.min(c), most.max(c))
    });
    least.max(-most).max(0.0)
}

impl<'a> Cell<'a> {
    fn new(
        grid: &'a Grid,
        source: &'a Source<'a>,
        quantizer: Quantizer,
        tolerance: Tolerance,
    ) -> Self {
        Self {
            grid,
            source,
            quantizer,
            tolerance,
            first: [0; 3],
            samples: vec![None; SIDE * SIDE * SIDE],
            sampled: Vec::new(),
            guess: 0,
        }
    }

    /// The values a cell needs of its own, or none if the lattice is accurate enough.
    fn refine(&mut self, cell: [u32; 3], lattice: [Sample; 8]) -> Option<RefinedData> {
        self.first = cell.map(|c| c * CELL_EDGE_VOXELS);
        for i in self.sampled.drain(..) {
            self.samples[i] = None;
        }
        for (i, sample) in lattice.into_iter().enumerate() {
            let index = index(corner([0; 3], CELL_EDGE_VOXELS, i));
            self.samples[index] = Some(sample);
            self.sampled.push(index);
        }
        let coarse = self.cube([0; 3], CELL_EDGE_VOXELS);
        if self.is_accurate(&coarse, [0; 3], CELL_EDGE_VOXELS) {
            return None;
        }
        let half = CELL_EDGE_VOXELS / 2;
        let mut middle = [0.0; REFINED_CELL_VALUES];
        for (i, value) in (0..).zip(&mut middle) {
            let at = [i % 3, i / 3 % 3, i / 9].map(|c| c * half);
            *value = self.quantizer.quantize(self.sample(at).0);
        }
        let mut refined = RefinedData {
            middle,
            bricks: 0,
            values: Vec::new(),
        };
        for i in 0..8 {
            let octant = self.cube(corner([0; 3], half, i), half);
            if !self.is_accurate(&octant, octant.first, half) {
                for i in 0..8 {
                    let first = corner(octant.first, 2, i);
                    if !self.is_accurate(&octant, first, 2) {
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
                refined.values.push(self.quantizer.quantize(penetration));
            }
        }
        Some(refined)
    }

    /// The interpolation of the stored values at the corners of a cube.
    fn cube(&mut self, first: [u32; 3], size: u32) -> TrilinearCube {
        let corners = core::array::from_fn(|i| {
            let penetration = self.sample(corner(first, size, i)).0;
            f64::from(self.quantizer.quantize(penetration)) * self.quantizer.sigma()
        });
        TrilinearCube {
            first,
            size,
            corners,
        }
    }

    /// Whether a cube is accurate enough at all voxels of a part of it.
    fn is_accurate(&mut self, cube: &TrilinearCube, first: [u32; 3], size: u32) -> bool {
        if size == 1 {
            return self.is_accurate_at(cube, first);
        }
        // If it fails, it most often fails in the middle.
        if !self.is_accurate_at(cube, first.map(|c| c + size / 2)) {
            return false;
        }
        if self.is_proven_accurate(cube, first, size) {
            return true;
        }
        let half = size / 2;
        (0..8).all(|i| self.is_accurate(cube, corner(first, half, i), half))
    }

    /// Whether a cube is accurate enough at one voxel.
    fn is_accurate_at(&mut self, cube: &TrilinearCube, voxel: [u32; 3]) -> bool {
        if !self.is_in_grid(voxel) {
            return true;
        }
        let exact = self.sample(voxel).0;
        let given = cube.at(voxel);
        let Tolerance {
            beyond_band,
            narrow_band,
            in_band,
        } = self.tolerance;
        let is_far = exact.abs() > narrow_band && given.abs() > narrow_band;
        (exact - given).abs() <= if is_far { beyond_band } else { in_band }
    }

    /// Whether a few distances prove that a cube is accurate enough.
    ///
    /// Let d be the distance to the mesh, g the interpolated one, x a point of the part, x_i its
    /// corners and w_i their trilinear weights.
    ///
    /// * The squared distance to a set curves no more than that to a point: d(x)² ≥ Σ w_i d_i² − Σ
    ///   w_i |x − x_i|². With t from 0 to 1 across the part along an axis, the last sum is that of
    ///   t (1 − t) size² over the axes. The first sum exceeds (Σ w_i d_i)² by at least that of t (1
    ///   − t) m², where m is the smallest change of d along the edges of the axis. So d(x)² ≥ (Σ
    ///   w_i d_i)² − Σ (size² − m²) / 4. Thus g exceeds d by no more than its largest excess at a
    ///   corner plus the loss this implies at the smallest d_i.
    /// * d(x) is no more than the distance to any point of the mesh, and the closest points to the
    ///   corners and the middle are known.
    fn is_proven_accurate(&mut self, cube: &TrilinearCube, first: [u32; 3], size: u32) -> bool {
        let Tolerance {
            beyond_band,
            narrow_band,
            ..
        } = self.tolerance;
        let edge = f64::from(size) * f64::from(self.grid.voxel_size());
        let half_diagonal = 0.8661 * edge;
        let (penetration, Some(closest)) = self.sample(first.map(|c| c + size / 2)) else {
            return false;
        };
        if penetration.abs() <= half_diagonal + narrow_band {
            return false;
        }
        let sign = penetration.signum();
        let corners: [[u32; 3]; 8] = core::array::from_fn(|i| corner(first, size, i));
        let given = corners.map(|at| cube.at(at) * sign);
        if given.iter().any(|&g| g <= narrow_band) {
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
        let sagitta = nearest - (nearest * nearest - loss).sqrt();
        let excess = (0..8).map(|i| given[i] - exact[i]);
        if excess.fold(0.0, f64::max) + sagitta > beyond_band {
            return false;
        }
        // The distance to a point is convex: a bound at all corners holds between them.
        let is_near =
            |i: usize| self.center(corners[i]).distance(closest) - given[i] <= beyond_band;
        if (0..8).all(is_near) {
            return true;
        }
        let at_corners = samples.map(|(_, point)| point.unwrap_or(closest));
        let (low, voxel) = (self.center(first), f64::from(self.grid.voxel_size()));
        let side = size + 1;
        (0..side * side * side).all(|i| {
            let step = [i % side, i / side % side, i / (side * side)];
            let at = low + DVec3::from_array(step.map(f64::from)) * voxel;
            let most = cube.at([0, 1, 2].map(|a| first[a] + step[a])) * sign + beyond_band;
            let is_near = |c: &DVec3| c.distance_squared(at) <= most * most;
            // Most often the closest point of the nearest corner suffices.
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
        self.sampled.push(index);
        sample
    }
}
