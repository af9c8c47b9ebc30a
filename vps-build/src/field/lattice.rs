//! Penetrations at voxels, and the coarse lattice of them at the corners of cells.

use glamx::DVec3;
use rayon::prelude::*;
use vps_core::Grid;
use vps_core::raw::{CELL_EDGE_VOXELS, cell_dims};

use super::distance::ExactDistances;

/// The source of the penetrations of voxels, in metres.
pub(crate) enum Source<'a> {
    /// Computed from the mesh. A few samples can bound all voxels between them.
    Exact(&'a ExactDistances<'a>),
    /// A table of all voxels.
    Table(&'a [f32]),
}

/// A voxel's penetration in metres, and the closest point of the mesh if known.
pub(super) type Sample = (f64, Option<DVec3>);

/// The samples at the corners of all cells.
pub(crate) struct Lattice {
    dims: [u32; 3],
    pub(super) samples: Vec<Sample>,
}

impl Source<'_> {
    pub(super) fn at(&self, grid: &Grid, voxel: [u32; 3], guess: &mut u32) -> Sample {
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
            let mut at = |x| self.at(grid, [x, y, z].map(|c| c * CELL_EDGE_VOXELS), &mut guess);
            (0..nx).map(&mut at).collect::<Vec<_>>()
        };
        Lattice {
            dims,
            samples: rows.par_iter().flat_map_iter(row).collect(),
        }
    }
}

impl Lattice {
    /// An upper bound of the absolute penetration of any voxel, in metres.
    pub(crate) fn largest(&self, voxel_size: f64) -> f64 {
        let largest = self.samples.iter().fold(0.0, |l: f64, s| l.max(s.0.abs()));
        // Half the diagonal of a cell.
        largest + 0.8661 * f64::from(CELL_EDGE_VOXELS) * voxel_size
    }

    pub(super) fn corners(&self, cell: [u32; 3]) -> [Sample; 8] {
        let [nx, ny, _] = self.dims.map(|n| n as usize);
        core::array::from_fn(|i| {
            let at = [0, 1, 2].map(|a| cell[a] as usize + (i >> a & 1));
            self.samples[(at[2] * ny + at[1]) * nx + at[0]]
        })
    }
}
