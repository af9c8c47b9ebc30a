//! The layers of a voxelmap (section 2.1.1).

use vps_core::Grid;

use crate::places::{Place, Places};

/// The layer v of every voxel: 0 on the surface, n in the nth inner layer, −n in the nth outer
/// one. A voxel is one layer further than the closest of the 26 around it.
pub(crate) fn layers(grid: &Grid, places: &Places) -> Vec<i16> {
    const UNKNOWN: i16 = i16::MAX;
    let [nx, ny, nz] = grid.dims().map(|n| n as i64);
    let voxel = |i: usize| {
        let i = i as i64;
        [i % nx, i / nx % ny, i / (nx * ny)].map(|c| c as u32)
    };
    let is_surface = |i: usize| places.of(voxel(i)) == Place::Surface;
    let mut layers: Vec<i16> = (0..grid.voxel_count())
        .map(|i| if is_surface(i) { 0 } else { UNKNOWN })
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
    for (i, layer) in layers.iter_mut().enumerate() {
        if places.of(voxel(i)) == Place::Outside {
            *layer = -*layer;
        }
    }
    layers
}

#[cfg(test)]
mod tests {
    use vps_core::Vec3;

    use super::*;
    use crate::Mesh;

    #[test]
    fn a_box_is_filled_and_layered() {
        // Faces in the middle of voxels: 9 voxels along each edge, the outer ones surface.
        let mesh = Mesh::cuboid([8.0, 8.0, 8.0]).unwrap();
        let grid = Grid::new(Vec3::splat(-7.5), 1.0, [15, 15, 15]).unwrap();
        let (places, _) = Places::by_winding(&mesh, &grid);
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
                    assert_eq!(places.of([x, y, z].map(|c| c as u32)), place);
                }
            }
        }
    }
}
