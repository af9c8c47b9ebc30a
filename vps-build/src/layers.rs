//! The layered voxelmap (section 2.1.1): surface voxels by triangle-box overlap, the outside by a
//! scan-line fill, everything else inside.

use glamx::DVec3;
use vps_core::Grid;

use crate::{Mesh, sat};

/// Where a voxel lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Place {
    /// Shares a point with a triangle: v = 0.
    Surface,
    /// Cannot be reached from outside: v > 0.
    Inside,
    /// v < 0.
    Outside,
}

/// Labels every voxel; the outermost ones must lie outside of the box of the mesh.
///
/// Closed cavities are inside: nothing can reach them.
pub(crate) fn places(mesh: &Mesh, grid: &Grid) -> Vec<Place> {
    let mut places = vec![Place::Inside; grid.voxel_count()];
    let origin = grid.origin().as_dvec3();
    let size = f64::from(grid.voxel_size());
    let dims = grid.dims();
    for t in 0..mesh.triangles().len() {
        for_each_overlapped(mesh.corners(t), origin, size, |cell, _| {
            let in_grid = (0..3).all(|a| (0..i64::from(dims[a])).contains(&cell[a]));
            if in_grid {
                places[grid.index(cell.map(|c| c as u32))] = Place::Surface;
            }
        });
    }
    fill_outside(grid, &mut places);
    places
}

/// Calls `visit` with every cell of a cubical lattice that shares a point with the triangle, and
/// with the cell's centre.
pub(crate) fn for_each_overlapped(
    triangle: [DVec3; 3],
    origin: DVec3,
    size: f64,
    mut visit: impl FnMut([i64; 3], DVec3),
) {
    let [a, b, c] = triangle.map(|v| (v - origin) / size);
    let nudge = DVec3::splat(1e-9);
    let low = (a.min(b).min(c) - nudge).floor().as_i64vec3();
    let high = (a.max(b).max(c) + nudge).floor().as_i64vec3();
    for z in low.z..=high.z {
        for y in low.y..=high.y {
            for x in low.x..=high.x {
                let center = origin + (DVec3::new(x as f64, y as f64, z as f64) + 0.5) * size;
                if sat::overlaps(triangle, center, 0.5 * size) {
                    visit([x, y, z], center);
                }
            }
        }
    }
}

/// Marks what can be reached from the border of the grid through faces of voxels that are not
/// surface: run by run along x, so that the stack stays small (after Kaufman and Shimony, 1986).
fn fill_outside(grid: &Grid, places: &mut [Place]) {
    let [nx, ny, nz] = grid.dims().map(|n| n as usize);
    let mut seeds = Vec::new();
    // A mesh that reaches a corner of its box may cut the border into parts.
    for z in 0..nz {
        for y in 0..ny {
            let whole_row = z == 0 || z + 1 == nz || y == 0 || y + 1 == ny;
            let step = if whole_row { 1 } else { nx.max(2) - 1 };
            seeds.extend((0..nx).step_by(step).map(|x| (x, y, z)));
        }
    }
    while let Some((x, y, z)) = seeds.pop() {
        let row = (z * ny + y) * nx;
        if places[row + x] != Place::Inside {
            continue;
        }
        let open = |x: &usize| places[row + x] == Place::Inside;
        let start = (0..x).rev().take_while(open).last().unwrap_or(x);
        let end = x + (x..nx).take_while(open).count();
        places[row + start..row + end].fill(Place::Outside);
        let neighbours = [
            (y > 0).then(|| (y - 1, z)),
            (y + 1 < ny).then_some((y + 1, z)),
            (z > 0).then(|| (y, z - 1)),
            (z + 1 < nz).then_some((y, z + 1)),
        ];
        for (y, z) in neighbours.into_iter().flatten() {
            let row = &places[(z * ny + y) * nx..][..nx];
            let mut in_run = false;
            for (x, &place) in row[start..end].iter().enumerate() {
                let fresh = place == Place::Inside;
                if fresh && !in_run {
                    seeds.push((start + x, y, z));
                }
                in_run = fresh;
            }
        }
    }
}

/// The layer v of every voxel: 0 on the surface, n in the nth inner layer, −n in the nth outer
/// one. A voxel is one layer further than the closest of the 26 around it.
pub(crate) fn layers(grid: &Grid, places: &[Place]) -> Vec<i16> {
    const UNKNOWN: i16 = i16::MAX;
    let [nx, ny, nz] = grid.dims().map(|n| n as i64);
    let mut layers: Vec<i16> = places
        .iter()
        .map(|&p| if p == Place::Surface { 0 } else { UNKNOWN })
        .collect();
    // Two sweeps, each over the half of the neighbours that come before in its order.
    let mut before = Vec::new();
    for dz in -1..=0_i64 {
        for dy in -1..=1_i64 {
            for dx in -1..=1_i64 {
                if (dz, dy, dx) < (0, 0, 0) {
                    before.push((dx, dy, dz));
                }
            }
        }
    }
    for direction in [1, -1] {
        for step in 0..nx * ny * nz {
            let i = if direction == 1 {
                step
            } else {
                nx * ny * nz - 1 - step
            };
            let (x, y, z) = (i % nx, i / nx % ny, i / (nx * ny));
            let mut layer = layers[i as usize];
            for &(dx, dy, dz) in &before {
                let (x, y, z) = (x + direction * dx, y + direction * dy, z + direction * dz);
                let in_grid = (0..nx).contains(&x) && (0..ny).contains(&y) && (0..nz).contains(&z);
                if in_grid {
                    let neighbour = layers[((z * ny + y) * nx + x) as usize];
                    layer = layer.min(neighbour.saturating_add(1));
                }
            }
            layers[i as usize] = layer;
        }
    }
    for (layer, place) in layers.iter_mut().zip(places) {
        if *place == Place::Outside {
            *layer = -*layer;
        }
    }
    layers
}

#[cfg(test)]
mod tests {
    use vps_core::Vec3;

    use super::*;

    /// The corner of the mesh marks the corner of the grid, where a fill might have started.
    #[test]
    fn a_mesh_in_the_corner_of_its_box_is_filled_right() {
        let v = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z].map(|v| v * 8.0);
        let mesh = Mesh::new(&v, &[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]).unwrap();
        let grid = Grid::new(Vec3::splat(-1.0), 1.0, [10, 10, 10]).unwrap();
        let places = places(&mesh, &grid);
        let at = |x, y, z| places[grid.index([x, y, z])];
        assert_eq!(at(0, 0, 0), Place::Surface);
        assert_eq!(at(3, 2, 2), Place::Inside);
        for outside in [(9, 9, 9), (0, 9, 9), (9, 0, 9), (9, 9, 0), (5, 6, 7)] {
            assert_eq!(at(outside.0, outside.1, outside.2), Place::Outside);
        }
    }

    #[test]
    fn a_box_is_filled_and_layered() {
        // Faces in the middle of voxels: 9 voxels along each edge, the outer ones surface.
        let mesh = Mesh::cuboid([8.0, 8.0, 8.0]).unwrap();
        let grid = Grid::new(Vec3::splat(-7.5), 1.0, [15, 15, 15]).unwrap();
        let places = places(&mesh, &grid);
        let layers = layers(&grid, &places);
        for z in 0..15 {
            for y in 0..15 {
                for x in 0..15 {
                    // Chebyshev distance from the centre voxel, 7.
                    let out = [x, y, z]
                        .map(|c: i32| (c - 7).abs())
                        .into_iter()
                        .max()
                        .unwrap();
                    let i = grid.index([x, y, z].map(|c| c as u32));
                    assert_eq!(i32::from(layers[i]), 4 - out, "{x} {y} {z}");
                    let place = match out.cmp(&4) {
                        std::cmp::Ordering::Less => Place::Inside,
                        std::cmp::Ordering::Equal => Place::Surface,
                        std::cmp::Ordering::Greater => Place::Outside,
                    };
                    assert_eq!(places[i], place);
                }
            }
        }
    }
}
