//! The layers of a voxelmap (section 2.1.1).

use vps_core::Grid;

use crate::solid::voxelize::{VoxelClass, VoxelClasses};

/// The layer v of every voxel: 0 on the surface, n in the n-th inner layer, −n in the n-th outer
/// one. A voxel is one layer further than the closest of its 26 neighbours.
pub(crate) fn layers(grid: &Grid, classes: &VoxelClasses) -> Vec<i16> {
    const UNKNOWN: i16 = i16::MAX;
    let [nx, ny, nz] = grid.dims();
    let voxels =
        || (0..nz).flat_map(move |z| (0..ny).flat_map(move |y| (0..nx).map(move |x| [x, y, z])));
    let start = |voxel| match classes.of(voxel) {
        VoxelClass::Surface => 0,
        VoxelClass::Inside | VoxelClass::Outside => UNKNOWN,
    };
    let mut layers: Vec<i16> = voxels().map(start).collect();
    // Two sweeps, each over the neighbours that come earlier in its order.
    let [nx, ny, nz] = grid.dims().map(|n| n as usize);
    let rows: Vec<(usize, usize)> = (0..nz).flat_map(|z| (0..ny).map(move |y| (y, z))).collect();
    let mut least = vec![UNKNOWN; nx];
    let mut sweep = |rows: &mut dyn Iterator<Item = &(usize, usize)>, ahead: bool| {
        for &(y, z) in rows {
            least.fill(UNKNOWN);
            let mut take = |y: Option<usize>, z: Option<usize>| {
                if let (Some(y), Some(z)) = (y.filter(|&y| y < ny), z.filter(|&z| z < nz)) {
                    let row = &layers[(z * ny + y) * nx..][..nx];
                    for (least, &layer) in least.iter_mut().zip(row) {
                        *least = layer.min(*least);
                    }
                }
            };
            let (before, after) = (|c: usize| c.checked_sub(1), |c: usize| Some(c + 1));
            let last_z = if ahead { before(z) } else { after(z) };
            take(before(y), last_z);
            take(Some(y), last_z);
            take(after(y), last_z);
            take(if ahead { before(y) } else { after(y) }, Some(z));
            let row = &mut layers[(z * ny + y) * nx..][..nx];
            for x in 0..nx {
                let near = &least[x.saturating_sub(1)..(x + 2).min(nx)];
                let near = near.iter().fold(UNKNOWN, |a, &b| a.min(b));
                row[x] = row[x].min(near.saturating_add(1));
            }
            let mut last = UNKNOWN;
            let mut along = |layer: &mut i16| {
                *layer = last.saturating_add(1).min(*layer);
                last = *layer;
            };
            if ahead {
                row.iter_mut().for_each(&mut along);
            } else {
                row.iter_mut().rev().for_each(&mut along);
            }
        }
    };
    sweep(&mut rows.iter(), true);
    sweep(&mut rows.iter().rev(), false);
    for (layer, voxel) in layers.iter_mut().zip(voxels()) {
        if classes.of(voxel) == VoxelClass::Outside {
            *layer = -*layer;
        }
    }
    layers
}

#[cfg(test)]
mod tests {
    use vps_core::Vec3;

    use super::*;
    use crate::mesh::Mesh;

    #[test]
    fn a_box_is_filled_and_layered() {
        // Faces through the centres of voxels: 9 voxels along each edge, the outermost on the
        // surface.
        let mesh = Mesh::cuboid([8.0, 8.0, 8.0]).unwrap();
        let grid = Grid::new(Vec3::splat(-7.5), 1.0, [15, 15, 15]).unwrap();
        let (classes, _) = VoxelClasses::by_winding(&mesh, &grid);
        let layers = layers(&grid, &classes);
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
                    let class = match out.cmp(&4) {
                        std::cmp::Ordering::Less => VoxelClass::Inside,
                        std::cmp::Ordering::Equal => VoxelClass::Surface,
                        std::cmp::Ordering::Greater => VoxelClass::Outside,
                    };
                    assert_eq!(classes.of([x, y, z].map(|c| c as u32)), class);
                }
            }
        }
    }
}
