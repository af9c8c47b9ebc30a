//! Distances from voxel centres to the mesh (section 2.1.1).

use glamx::DVec3;
use rayon::prelude::*;
use rustc_hash::FxHashMap;
use vps_core::Grid;

use crate::Mesh;
use crate::bvh::{Bvh, Closest};
use crate::layers::layers;
use crate::places::{AROUND, Places};
use crate::triangle::closest_point;

/// Exact penetrations, each found when it is asked for.
pub(crate) struct Exact<'a> {
    grid: &'a Grid,
    places: &'a Places,
    bvh: &'a Bvh,
}

impl<'a> Exact<'a> {
    pub(crate) fn new(bvh: &'a Bvh, grid: &'a Grid, places: &'a Places) -> Self {
        Self { grid, places, bvh }
    }

    /// The penetration of a voxel's centre in metres, positive inside, and the closest point of
    /// the mesh. The voxel may lie beyond the grid; `guess` is a triangle that may be close, and
    /// becomes the closest one.
    pub(crate) fn at(&self, voxel: [u32; 3], guess: &mut u32) -> (f64, DVec3) {
        let center = self.grid.center(voxel).as_dvec3();
        let Closest {
            distance,
            point,
            triangle,
        } = self.bvh.closest(center, *guess);
        *guess = triangle;
        let is_inside = self.places.is_inside(voxel);
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

/// The penetrations of all voxels as the paper finds them: exact for surface voxels; for the
/// others the distance to the triangle that is closest to the centre of the surface voxel which
/// is reached by following the gradient of the layered map.
///
/// Never too small, and too large by as much as a way along layers can be longer than a straight
/// one.
pub(crate) fn by_gradient_walk(mesh: &Mesh, bvh: &Bvh, grid: &Grid, places: &Places) -> Vec<f32> {
    let layers = layers(grid, places);
    let [nx, ny, _] = grid.dims().map(|n| n as usize);
    let voxel = |i: usize| [i % nx, i / nx % ny, i / (nx * ny)].map(|c| c as u32);
    // The surface voxel each walk ends at. Walks that meet go on as one.
    let mut ends = vec![UNKNOWN; grid.voxel_count()];
    let mut way = Vec::new();
    for start in 0..ends.len() {
        let mut at = start;
        while ends[at] == UNKNOWN {
            if layers[at] == 0 {
                ends[at] = at as u32;
                break;
            }
            way.push(at);
            at = grid.index(next_lower(&layers, grid, voxel(at)));
        }
        let end = ends[at];
        for passed in way.drain(..) {
            ends[passed] = end;
        }
    }
    // The triangle closest to each surface voxel, in place of the voxel.
    let exact = Exact::new(bvh, grid, places);
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
        let penetration = if places.is_inside(voxel(i)) {
            distance
        } else {
            -distance
        };
        // In its place again: the numbers are as long as the penetrations.
        *end = (penetration as f32).to_bits();
    };
    ends.par_iter_mut().enumerate().for_each(penetration);
    bytemuck::cast_vec(ends)
}

/// No walk has been here.
const UNKNOWN: u32 = u32::MAX;

/// The neighbour one layer lower that lies closest to the gradient of the layers, for a voxel that
/// is not on the surface.
fn next_lower(layers: &[i16], grid: &Grid, voxel: [u32; 3]) -> [u32; 3] {
    let dims = grid.dims();
    let step = |step: [i32; 3]| {
        let next = [0, 1, 2].map(|a| voxel[a].wrapping_add_signed(step[a]));
        (0..3).all(|a| next[a] < dims[a]).then_some(next)
    };
    let layer = |at: [u32; 3]| i32::from(layers[grid.index(at)].unsigned_abs());
    let here = layer(voxel);
    let slope = [0, 1, 2].map(|axis| {
        let mut way = [0; 3];
        way[axis] = 1;
        let ahead = step(way).map_or(here, layer);
        let behind = step(way.map(|w: i32| -w)).map_or(here, layer);
        behind - ahead
    });
    let mut best = (f32::NEG_INFINITY, voxel);
    for way in AROUND {
        let Some(next) = step(way) else { continue };
        let along: i32 = (0..3).map(|a| way[a] * slope[a]).sum();
        let length: i32 = way.iter().map(|w| w * w).sum();
        let steepness = along as f32 / (length as f32).sqrt();
        if steepness > best.0 && layer(next) < here {
            best = (steepness, next);
        }
    }
    best.1
}
