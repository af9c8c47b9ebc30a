//! How much the field bends around each cell of voxels: what lets a query bound it by a linear
//! function (see [`vps_core::Voxelmap::new`]).

use rayon::prelude::*;
use vps_core::store::{CELL, cell_dims};
use vps_core::{BEND_STEPS, Store, UNKNOWN_BEND};

/// Bends are known where the field is within so many voxels of the surface: that is where queries
/// look.
const KNOWN: f32 = 24.0;

/// Values along an edge of a cell and of the voxels around it.
const EDGE: usize = CELL as usize + 2;

/// The bends of a map with these values, each worth `sigma` voxels.
pub(crate) fn bends(store: &Store<'_>, sigma: f32) -> Vec<u8> {
    let cells = cell_dims(store.dims());
    let count: usize = cells.iter().map(|&n| n as usize).product();
    let place = |i: usize| {
        let [nx, ny, _] = cells.map(|n| n as usize);
        [i % nx, i / nx % ny, i / (nx * ny)].map(|c| c as u32)
    };
    let own: Vec<u8> = (0..count)
        .into_par_iter()
        .map(|i| bend_of_cell(store, sigma, place(i)))
        .collect();
    // What a ball reaches from a cell lies in the cells around it.
    let around = |i: usize| {
        let at = place(i);
        let reach = [0, 1, 2].map(|a| (at[a].saturating_sub(1), (at[a] + 1).min(cells[a] - 1)));
        let mut most = 0;
        for z in reach[2].0..=reach[2].1 {
            for y in reach[1].0..=reach[1].1 {
                for x in reach[0].0..=reach[0].1 {
                    most = most.max(own[((z * cells[1] + y) * cells[0] + x) as usize]);
                }
            }
        }
        most
    };
    (0..count).into_par_iter().map(around).collect()
}

fn bend_of_cell(store: &Store<'_>, sigma: f32, cell: [u32; 3]) -> u8 {
    let dims = store.dims();
    let middle = [0, 1, 2].map(|a| (cell[a] * CELL + CELL / 2).min(dims[a] - 1));
    if (store.value(middle) * sigma).abs() > KNOWN {
        return UNKNOWN_BEND;
    }
    // Repeated behind the border, and not looked at there.
    let mut values = [[[0.0_f32; EDGE]; EDGE]; EDGE];
    for (z, plane) in values.iter_mut().enumerate() {
        for (y, row) in plane.iter_mut().enumerate() {
            for (x, value) in row.iter_mut().enumerate() {
                let local = [x, y, z];
                let voxel = [0, 1, 2].map(|a| {
                    let at = (cell[a] * CELL + local[a] as u32).saturating_sub(1);
                    at.min(dims[a] - 1)
                });
                *value = store.value(voxel);
            }
        }
    }
    let mut most = 0.0_f32;
    for z in 1..EDGE - 1 {
        for y in 1..EDGE - 1 {
            for x in 1..EDGE - 1 {
                let local = [x, y, z];
                let voxel = [0, 1, 2].map(|a| cell[a] * CELL + local[a] as u32 - 1);
                if (0..3).any(|a| voxel[a] >= dims[a]) {
                    continue;
                }
                // The value so many steps along each axis from here.
                let at = |steps: [i32; 3]| {
                    let [x, y, z] =
                        [0, 1, 2].map(|a| local[a].wrapping_add_signed(steps[a] as isize));
                    values[z][y][x]
                };
                let here = at([0; 3]);
                let has_next = [0, 1, 2].map(|a| voxel[a] + 1 < dims[a]);
                for a in 0..3 {
                    let mut next = [0; 3];
                    next[a] = 1;
                    if has_next[a] && voxel[a] > 0 {
                        most = most.max(at(next) + at(next.map(|c| -c)) - 2.0 * here);
                    }
                    let b = (a + 1) % 3;
                    if has_next[a] && has_next[b] {
                        let mut aside = [0; 3];
                        aside[b] = 1;
                        let mut both = next;
                        both[b] = 1;
                        most = most.max((at(both) - at(next) - at(aside) + here).abs());
                    }
                }
            }
        }
    }
    // Rounded up, and more than any rounding here can take away.
    let steps = (most * sigma * BEND_STEPS * 1.0001).ceil();
    if steps < f32::from(UNKNOWN_BEND) {
        steps as u8
    } else {
        UNKNOWN_BEND
    }
}
