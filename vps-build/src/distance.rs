//! Distances from voxel centres to the mesh (section 2.1.1).
//!
//! Up to [`BAND`] voxels from the surface a distance is exact. Beyond, it is the distance to the
//! triangle closest to the closest surface voxel, which is never too small and at most √3 s too
//! large: the closest point of the mesh lies in some surface voxel, whose centre is no more than
//! √3/2 s away from it, and so is that of the closest surface voxel from its triangle.

use glamx::DVec3;
use rayon::prelude::*;
use vps_core::Grid;

use crate::Mesh;
use crate::layers::Place;
use crate::triangle::{Pseudonormals, closest_point};

/// Up to how many voxels from the surface distances are exact.
pub(crate) const BAND: u32 = 4;

/// How many times the voxel size a distance beyond the band can be too large: √3.
pub(crate) const FAR_ERROR: f64 = 1.733;

/// Slices along z that one thread works on at a time.
const SLAB: usize = 8;

/// Bytes a voxel takes, beside its place and its distance, while its slab is worked on.
pub(crate) const BYTES_PER_VOXEL_AT_ONCE: u64 = size_of::<(f64, u32)>() as u64;

/// How many slices are worked on at a time by all threads.
pub(crate) fn slices_at_once() -> usize {
    SLAB * rayon::current_num_threads()
}

/// The penetration of every voxel centre in metres, positive inside.
pub(crate) fn penetrations(mesh: &Mesh, grid: &Grid, places: &[Place]) -> Vec<f32> {
    let mut penetrations = vec![f32::INFINITY; grid.voxel_count()];
    let surface = near_surface(mesh, grid, places, &mut penetrations);
    far_away(mesh, grid, &surface, &mut penetrations);
    penetrations
        .par_iter_mut()
        .zip(places)
        .filter(|(_, place)| **place == Place::Outside)
        .for_each(|(penetration, _)| *penetration = -*penetration);
    surface.make_signed(&mut penetrations);
    penetrations
}

/// A surface voxel.
struct SurfaceVoxel {
    x: u16,
    /// Position among all voxels.
    index: u32,
    /// The triangle closest to its centre.
    triangle: u32,
    inside: bool,
}

/// All surface voxels, in the order of the grid.
struct Surface {
    voxels: Vec<SurfaceVoxel>,
    /// Where each row of voxels along x starts in `voxels`.
    row_starts: Vec<u32>,
}

impl Surface {
    /// The triangle closest to the centre of a surface voxel.
    fn triangle(&self, row: usize, x: u16) -> usize {
        let [start, end] = [row, row + 1].map(|r| self.row_starts[r] as usize);
        let voxels = &self.voxels[start..end];
        let at = voxels.binary_search_by_key(&x, |v| v.x);
        voxels[at.expect("features are surface voxels")].triangle as usize
    }

    fn make_signed(&self, penetrations: &mut [f32]) {
        for voxel in self.voxels.iter().filter(|v| !v.inside) {
            let penetration = &mut penetrations[voxel.index as usize];
            *penetration = -*penetration;
        }
    }
}

/// Exact unsigned distances up to [`BAND`] voxels from each triangle: every triangle offers its
/// distance to all voxels around it.
fn near_surface(mesh: &Mesh, grid: &Grid, places: &[Place], distances: &mut [f32]) -> Surface {
    let [nx, ny, _] = grid.dims().map(|n| n as usize);
    let size = f64::from(grid.voxel_size());
    let reach = f64::from(BAND) * size;
    let ranges: Vec<_> = (0..mesh.triangles().len())
        .map(|t| {
            let [a, b, c] = mesh.corners(t);
            voxel_range(grid, a.min(b).min(c) - reach, a.max(b).max(c) + reach)
        })
        .collect();
    let pseudonormals = Pseudonormals::new(mesh);
    let centers = Centers::new(grid);
    let slab_voxels = SLAB * nx * ny;
    let voxels: Vec<Vec<SurfaceVoxel>> = distances
        .par_chunks_mut(slab_voxels)
        .zip(places.par_chunks(slab_voxels))
        .enumerate()
        .map(|(slab, (distances, places))| {
            let slab_start = slab * SLAB;
            let slab_end = slab_start + distances.len() / (nx * ny);
            // The distance to beat and whose it is.
            let mut best = vec![(reach, 0_u32); distances.len()];
            for (t, (low, high)) in ranges.iter().enumerate() {
                let triangle = mesh.corners(t);
                let [a, b, c] = triangle;
                // No point of the triangle is further from its middle than this.
                let middle = (a + b + c) / 3.0;
                let radius = triangle
                    .map(|v| v.distance(middle))
                    .into_iter()
                    .fold(0.0, f64::max);
                let radius = radius * (1.0 + 1e-9);
                for z in low[2].max(slab_start)..(high[2] + 1).min(slab_end) {
                    for y in low[1]..=high[1] {
                        let row = ((z - slab_start) * ny + y) * nx;
                        let (dy, dz) = (centers.y[y] - middle.y, centers.z[z] - middle.z);
                        let aside = dy * dy + dz * dz;
                        for x in low[0]..=high[0] {
                            let best = &mut best[row + x];
                            let dx = centers.x[x] - middle.x;
                            let hopeless = best.0 + radius;
                            if dx * dx + aside > hopeless * hopeless {
                                continue;
                            }
                            let center = centers.of([x, y, z]);
                            let distance = closest_point(triangle, center).0.distance(center);
                            if distance < best.0 {
                                *best = (distance, t as u32);
                            }
                        }
                    }
                }
            }
            let mut surface = Vec::new();
            for (i, &(distance, triangle)) in best.iter().enumerate() {
                if distance < reach {
                    distances[i] = distance as f32;
                }
                if places[i] == Place::Surface {
                    let (x, y, z) = (i % nx, i / nx % ny, i / (nx * ny) + slab_start);
                    let center = centers.of([x, y, z]);
                    let t = triangle as usize;
                    let closest = closest_point(mesh.corners(t), center);
                    surface.push(SurfaceVoxel {
                        x: x as u16,
                        index: (slab * slab_voxels + i) as u32,
                        triangle,
                        inside: pseudonormals.is_inside(center, t, closest),
                    });
                }
            }
            surface
        })
        .collect();
    let voxels: Vec<_> = voxels.into_iter().flatten().collect();
    let rows = distances.len() / nx;
    let row_starts = (0..=rows)
        .map(|row| voxels.partition_point(|v| (v.index as usize) < row * nx) as u32)
        .collect();
    Surface { voxels, row_starts }
}

/// Unsigned distances beyond the band, by an exact Euclidean feature transform of the surface
/// voxels (after Felzenszwalb and Huttenlocher, 2012): first along z, then y, then x.
fn far_away(mesh: &Mesh, grid: &Grid, surface: &Surface, distances: &mut [f32]) {
    let [nx, ny, _] = grid.dims().map(|n| n as usize);
    let along_z = closest_along_z(grid, surface);
    let centers = Centers::new(grid);
    distances
        .par_chunks_mut(nx * ny)
        .zip(along_z.par_chunks(nx * ny))
        .enumerate()
        .for_each(|(z, (distances, along_z))| {
            let mut envelope = Envelope::default();
            let squared = |a: usize, b: usize| (a as f64 - b as f64).powi(2);
            // The closest surface voxel of each column, for every y: its y.
            let mut along_y = vec![NONE; nx * ny];
            for x in 0..nx {
                let heights = (0..ny).map(|y| match along_z[y * nx + x] {
                    NONE => None,
                    feature => Some(squared(z, feature as usize)),
                });
                envelope.build(heights);
                envelope.read(ny, |y, feature| along_y[y * nx + x] = feature);
            }
            for y in 0..ny {
                let feature_z = |x: usize, y: u16| along_z[y as usize * nx + x];
                let heights = (0..nx).map(|x| match along_y[y * nx + x] {
                    NONE => None,
                    feature => {
                        let dz = squared(z, feature_z(x, feature) as usize);
                        Some(squared(y, feature as usize) + dz)
                    }
                });
                envelope.build(heights);
                let mut last = (NONE, 0);
                envelope.read(nx, |x, feature_x| {
                    let distance = &mut distances[y * nx + x];
                    if distance.is_finite() {
                        return;
                    }
                    if last.0 != feature_x {
                        let feature_y = along_y[y * nx + feature_x as usize];
                        let feature_z = feature_z(feature_x as usize, feature_y);
                        let row = feature_z as usize * ny + feature_y as usize;
                        last = (feature_x, surface.triangle(row, feature_x));
                    }
                    let center = centers.of([x, y, z]);
                    let (closest, _) = closest_point(mesh.corners(last.1), center);
                    *distance = closest.distance(center) as f32;
                });
            }
        });
}

/// No surface voxel in this line.
const NONE: u16 = u16::MAX;

/// For every voxel the z of the closest surface voxel above or below it.
fn closest_along_z(grid: &Grid, surface: &Surface) -> Vec<u16> {
    let [nx, ny, nz] = grid.dims().map(|n| n as usize);
    let slice = nx * ny;
    let mut closest = vec![NONE; grid.voxel_count()];
    for voxel in &surface.voxels {
        closest[voxel.index as usize] = (voxel.index as usize / slice) as u16;
    }
    for z in 1..nz {
        let (before, this) = closest.split_at_mut(z * slice);
        for (this, &below) in this[..slice].iter_mut().zip(&before[(z - 1) * slice..]) {
            if *this == NONE {
                *this = below;
            }
        }
    }
    for z in (0..nz - 1).rev() {
        let (this, after) = closest.split_at_mut((z + 1) * slice);
        for (this, &above) in this[z * slice..].iter_mut().zip(&after[..slice]) {
            let away = |feature: u16| (i64::from(feature) - z as i64).abs();
            if above != NONE && (*this == NONE || away(above) < away(*this)) {
                *this = above;
            }
        }
    }
    closest
}

/// The lower envelope of parabolas (q − i)² + h_i over a line of voxels.
#[derive(Default)]
struct Envelope {
    /// Which parabolas it consists of, from left to right.
    parabolas: Vec<(u16, f64)>,
    /// From where on each is the lowest.
    starts: Vec<f64>,
}

impl Envelope {
    fn build(&mut self, heights: impl Iterator<Item = Option<f64>>) {
        self.parabolas.clear();
        self.starts.clear();
        for (i, height) in heights.enumerate() {
            let Some(height) = height else { continue };
            let at = i as f64;
            let mut start = f64::NEG_INFINITY;
            while let Some(&(last, last_height)) = self.parabolas.last() {
                let last = f64::from(last);
                start = ((height + at * at) - (last_height + last * last)) / (2.0 * (at - last));
                if start > self.starts[self.starts.len() - 1] {
                    break;
                }
                self.parabolas.pop();
                self.starts.pop();
                start = f64::NEG_INFINITY;
            }
            self.parabolas.push((i as u16, height));
            self.starts.push(start);
        }
    }

    /// Calls `visit` with every place up to `count` and the parabola that is lowest there, unless
    /// there is none at all.
    fn read(&self, count: usize, mut visit: impl FnMut(usize, u16)) {
        if self.parabolas.is_empty() {
            return;
        }
        let mut k = 0;
        for i in 0..count {
            while k + 1 < self.starts.len() && self.starts[k + 1] < i as f64 {
                k += 1;
            }
            visit(i, self.parabolas[k].0);
        }
    }
}

/// Coordinates of all voxel centres, as a query sees them.
struct Centers {
    x: Vec<f64>,
    y: Vec<f64>,
    z: Vec<f64>,
}

impl Centers {
    fn new(grid: &Grid) -> Self {
        let along = |axis: usize| {
            let center = |c| {
                let mut voxel = [0; 3];
                voxel[axis] = c;
                f64::from(grid.center(voxel)[axis])
            };
            (0..grid.dims()[axis]).map(center).collect()
        };
        Self {
            x: along(0),
            y: along(1),
            z: along(2),
        }
    }

    fn of(&self, [x, y, z]: [usize; 3]) -> DVec3 {
        DVec3::new(self.x[x], self.y[y], self.z[z])
    }
}

/// The first and the last voxel, along each axis, of those that hold a box.
fn voxel_range(grid: &Grid, low: DVec3, high: DVec3) -> ([usize; 3], [usize; 3]) {
    let [low, high] = [low, high].map(|p| grid.voxel_at(p.as_vec3()).map(|c| c as usize));
    (low, high)
}
