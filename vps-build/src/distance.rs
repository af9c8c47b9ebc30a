//! Distances from voxel centres to the mesh (section 2.1.1).

use glamx::DVec3;
use rayon::prelude::*;
use vps_core::Grid;

use crate::Mesh;
use crate::bvh::{Bvh, Closest};
use crate::layers::layers;
use crate::places::{AROUND, Place, Places};
use crate::triangle::closest_point;

/// Exact penetrations, each found when it is asked for.
pub(crate) struct Exact<'a> {
    grid: &'a Grid,
    places: &'a Places,
    bvh: Bvh,
}

impl<'a> Exact<'a> {
    pub(crate) fn new(mesh: &Mesh, grid: &'a Grid, places: &'a Places) -> Self {
        Self {
            grid,
            places,
            bvh: Bvh::new(mesh),
        }
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
pub(crate) fn by_gradient_walk(mesh: &Mesh, grid: &Grid, places: &Places) -> Vec<f32> {
    let layers = layers(grid, places);
    let dims = grid.dims().map(i64::from);
    let layer = |at: [i64; 3]| {
        let inside = [0, 1, 2].map(|a| at[a].clamp(0, dims[a] - 1) as u32);
        i64::from(layers[grid.index(inside)].unsigned_abs())
    };
    let walk = |mut at: [i64; 3]| {
        while layer(at) > 0 {
            let slope = [0, 1, 2].map(|a| {
                let (mut ahead, mut behind) = (at, at);
                ahead[a] += 1;
                behind[a] -= 1;
                layer(behind) - layer(ahead)
            });
            // The neighbour that lies closest to the way down, among those a layer lower.
            let downhill = |step: &[i64; 3]| {
                let next = [0, 1, 2].map(|a| at[a] + step[a]);
                let in_grid = (0..3).all(|a| (0..dims[a]).contains(&next[a]));
                in_grid && layer(next) < layer(at)
            };
            let steepness = |step: &[i64; 3]| {
                let along: i64 = (0..3).map(|a| step[a] * slope[a]).sum();
                let length: i64 = step.iter().map(|s| s * s).sum();
                along as f64 / (length as f64).sqrt()
            };
            let step = AROUND
                .map(|step| step.map(i64::from))
                .into_iter()
                .filter(downhill)
                .max_by(|a, b| steepness(a).total_cmp(&steepness(b)))
                .expect("each layer lies next to a lower one");
            at = [0, 1, 2].map(|a| at[a] + step[a]);
        }
        at.map(|c| c as u32)
    };
    let exact = Exact::new(mesh, grid, places);
    let [nx, ny, _] = grid.dims();
    let mut all = vec![0.0; grid.voxel_count()];
    all.par_chunks_mut(nx as usize)
        .enumerate()
        .for_each(|(row, penetrations)| {
            let mut guess = 0;
            let (y, z) = (row as u32 % ny, row as u32 / ny);
            for (x, penetration) in (0..nx).zip(penetrations) {
                let surface = walk([x, y, z].map(i64::from));
                exact.at(surface, &mut guess);
                let center = grid.center([x, y, z]).as_dvec3();
                let closest = closest_point(mesh.corners(guess as usize), center);
                let distance = closest.distance(center);
                let outside = match places.of([x, y, z]) {
                    Place::Outside => true,
                    Place::Inside => false,
                    Place::Surface => !places.is_inside([x, y, z]),
                };
                *penetration = if outside { -distance } else { distance } as f32;
            }
        });
    all
}
