//! Distances from voxel centres to the mesh (section 2.1.1).

use glamx::DVec3;
use rayon::prelude::*;
use rustc_hash::FxHashMap;
use vps_core::Grid;

use super::layers::layers;
use crate::mesh::Mesh;
use crate::mesh::triangle::closest_point;
use crate::solid::voxelize::VoxelClasses;
use crate::spatial::bvh::{Bvh, Closest};
use crate::spatial::lattice::NEIGHBOURS_26;

/// Exact penetrations, computed on demand.
pub(crate) struct ExactDistances<'a> {
    grid: &'a Grid,
    classes: &'a VoxelClasses,
    bvh: &'a Bvh,
}

impl<'a> ExactDistances<'a> {
    pub(crate) fn new(bvh: &'a Bvh, grid: &'a Grid, classes: &'a VoxelClasses) -> Self {
        Self { grid, classes, bvh }
    }

    /// The penetration of a voxel's centre in metres, positive inside, and the closest point of the
    /// mesh. The voxel may lie outside of the grid. `guess` is a triangle that may be close; it
    /// becomes the closest one.
    pub(crate) fn at(&self, voxel: [u32; 3], guess: &mut u32) -> (f64, DVec3) {
        let center = self.grid.center(voxel).as_dvec3();
        let Closest {
            distance,
            point,
            triangle,
        } = self.bvh.closest(center, *guess);
        *guess = triangle;
        let is_inside = self.classes.is_inside(voxel);
        (if is_inside { distance } else { -distance }, point)
    }

    /// The penetrations of all voxels.
    pub(crate) fn all(&self) -> Vec<f32> {
        let [nx, ny, _] = self.grid.dims();
        let mut all = vec![0.0; self.grid.voxel_count()];
        all.par_chunks_mut(nx as usize)
            .enumerate()
            .for_each(|(row, penetrations)| {
                let mut guess = 0;
                let (y, z) = (row as u32 % ny, row as u32 / ny);
                for (x, penetration) in (0..nx).zip(penetrations) {
                    *penetration = self.at([x, y, z], &mut guess).0 as f32;
                }
            });
        all
    }
}

/// The penetrations of all voxels as in the paper. Surface voxels are exact. Other voxels follow
/// the gradient of the layered map to a surface voxel, and take the distance to the triangle
/// closest to its centre.
///
/// Never too small. Too large by as much as a path along layers exceeds a straight one.
pub(crate) fn by_gradient_descent(
    mesh: &Mesh,
    bvh: &Bvh,
    grid: &Grid,
    classes: &VoxelClasses,
) -> Vec<f32> {
    let layers = layers(grid, classes);
    let [nx, ny, _] = grid.dims().map(|n| n as usize);
    let voxel = |i: usize| [i % nx, i / nx % ny, i / (nx * ny)].map(|c| c as u32);
    // The surface voxel at the end of each descent. Paths that meet continue as one.
    let mut ends = vec![UNVISITED; grid.voxel_count()];
    let mut path = Vec::new();
    for start in 0..ends.len() {
        let mut at = start;
        while ends[at] == UNVISITED {
            if layers[at] == 0 {
                ends[at] = at as u32;
                break;
            }
            path.push(at);
            at = grid.index(next_lower(&layers, grid, voxel(at)));
        }
        let end = ends[at];
        for passed in path.drain(..) {
            ends[passed] = end;
        }
    }
    // The triangle closest to each surface voxel.
    let exact = ExactDistances::new(bvh, grid, classes);
    let surface: Vec<u32> = (0..ends.len() as u32)
        .filter(|&i| layers[i as usize] == 0)
        .collect();
    let closest = |&i: &u32| {
        let mut guess = 0;
        exact.at(voxel(i as usize), &mut guess);
        guess
    };
    let triangles: Vec<u32> = surface.par_iter().map(closest).collect();
    let numbers: FxHashMap<u32, u32> = surface.into_iter().zip(triangles).collect();
    let penetration = |(i, end): (usize, &mut u32)| {
        let center = grid.center(voxel(i)).as_dvec3();
        let triangle = numbers[end] as usize;
        let distance = closest_point(mesh.corners(triangle), center).distance(center);
        let penetration = if classes.is_inside(voxel(i)) {
            distance
        } else {
            -distance
        };
        // Stored in place: both have 32 bits.
        *end = (penetration as f32).to_bits();
    };
    ends.par_iter_mut().enumerate().for_each(penetration);
    bytemuck::cast_vec(ends)
}

/// Not yet visited by a descent.
const UNVISITED: u32 = u32::MAX;

/// The neighbour one layer lower that is closest to the direction of the gradient. The voxel must
/// not be a surface voxel.
fn next_lower(layers: &[i16], grid: &Grid, voxel: [u32; 3]) -> [u32; 3] {
    let dims = grid.dims();
    let step = |step: [i32; 3]| {
        let next = [0, 1, 2].map(|a| voxel[a].wrapping_add_signed(step[a]));
        (0..3).all(|a| next[a] < dims[a]).then_some(next)
    };
    let layer = |at: [u32; 3]| i32::from(layers[grid.index(at)].unsigned_abs());
    let here = layer(voxel);
    let slope = [0, 1, 2].map(|axis| {
        let mut forward = [0; 3];
        forward[axis] = 1;
        let ahead = step(forward).map_or(here, layer);
        let behind = step(forward.map(|c: i32| -c)).map_or(here, layer);
        behind - ahead
    });
    let mut best = (f32::NEG_INFINITY, voxel);
    for offset in NEIGHBOURS_26 {
        let Some(next) = step(offset) else { continue };
        let along: i32 = (0..3).map(|a| offset[a] * slope[a]).sum();
        let length: i32 = offset.iter().map(|c| c * c).sum();
        let steepness = along as f32 / (length as f32).sqrt();
        if steepness > best.0 && layer(next) < here {
            best = (steepness, next);
        }
    }
    best.1
}
