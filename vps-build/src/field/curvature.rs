//! Curvature bounds: the largest second difference of the field around each cell of voxels.
//! With them a query bounds the field by a linear function (see [`vps_core::raw::VoxelmapParts`]).

use rayon::prelude::*;
use vps_core::raw::{CELL_EDGE_VOXELS, CURVATURE_STEPS, CURVATURE_UNKNOWN, Store, cell_dims};

/// Largest distance from the surface, in voxels, with a known bound. Queries rarely look beyond.
const MAX_DISTANCE: f32 = 24.0;

/// Values along an edge of a cell, with one more voxel at each end.
const EDGE: usize = CELL_EDGE_VOXELS as usize + 2;

/// The curvature bounds of a map, in steps of 1 / [`CURVATURE_STEPS`] voxels. A stored value is worth
/// `sigma` voxels.
pub(crate) fn curvature_bounds(store: &Store<'_>, sigma: f32) -> Vec<u8> {
    let cells = cell_dims(store.dims());
    let count: usize = cells.iter().map(|&n| n as usize).product();
    let cell_at = |i: usize| {
        let [nx, ny, _] = cells.map(|n| n as usize);
        [i % nx, i / nx % ny, i / (nx * ny)].map(|c| c as u32)
    };
    let own: Vec<u8> = (0..count)
        .into_par_iter()
        .map(|i| curvature_of_cell(store, sigma, cell_at(i)))
        .collect();
    // A ball around a point of a cell reaches into the neighbouring cells.
    let with_neighbours = |i: usize| {
        let at = cell_at(i);
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
    (0..count).into_par_iter().map(with_neighbours).collect()
}

fn curvature_of_cell(store: &Store<'_>, sigma: f32, cell: [u32; 3]) -> u8 {
    let dims = store.dims();
    let middle =
        [0, 1, 2].map(|a| (cell[a] * CELL_EDGE_VOXELS + CELL_EDGE_VOXELS / 2).min(dims[a] - 1));
    if (store.value(middle) * sigma).abs() > MAX_DISTANCE {
        return CURVATURE_UNKNOWN;
    }
    // Beyond the border of the grid values are repeated, and not used.
    let mut values = [[[0.0_f32; EDGE]; EDGE]; EDGE];
    for (z, plane) in values.iter_mut().enumerate() {
        for (y, row) in plane.iter_mut().enumerate() {
            for (x, value) in row.iter_mut().enumerate() {
                let local = [x, y, z];
                let voxel = [0, 1, 2].map(|a| {
                    let at = (cell[a] * CELL_EDGE_VOXELS + local[a] as u32).saturating_sub(1);
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
                let voxel = [0, 1, 2].map(|a| cell[a] * CELL_EDGE_VOXELS + local[a] as u32 - 1);
                if (0..3).any(|a| voxel[a] >= dims[a]) {
                    continue;
                }
                // The value at an offset along each axis.
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
    // Rounded up, by more than any rounding error here.
    let steps = (most * sigma * CURVATURE_STEPS * 1.0001).ceil();
    if steps < f32::from(CURVATURE_UNKNOWN) {
        steps as u8
    } else {
        CURVATURE_UNKNOWN
    }
}

#[cfg(test)]
mod tests {
    use vps_core::conformance::check;
    use vps_core::raw::{Discs, Points, Values, VoxelmapParts};
    use vps_core::{Aabb, DistanceField, ErrorBounds, Grid, Quat, Vec3, Voxelmap};

    use super::*;

    const VOXELS: u32 = 24;

    /// A map of voxels of one metre with exact values.
    fn map_of(penetration: impl Fn(Vec3) -> f32) -> Voxelmap<'static> {
        let grid = Grid::new(Vec3::splat(-0.5 * VOXELS as f32), 1.0, [VOXELS; 3]).unwrap();
        let mut values = Vec::new();
        for z in 0..VOXELS {
            for y in 0..VOXELS {
                for x in 0..VOXELS {
                    values.push(penetration(grid.center([x, y, z])));
                }
            }
        }
        let store = Store::dense(grid.dims(), Values::Floats(values.into())).unwrap();
        let curvature = curvature_bounds(&store, 1.0);
        let error_bounds = ErrorBounds {
            in_band: 0.0,
            beyond: 0.0,
            narrow_band: 100.0,
        };
        let solid = Aabb {
            min: Vec3::splat(-11.0),
            max: Vec3::splat(11.0),
        };
        Voxelmap::from_parts(VoxelmapParts {
            grid,
            sigma: 1.0,
            solid,
            error_bounds,
            store,
            curvature_bounds: curvature.into(),
        })
        .unwrap()
    }

    /// Checks fields at their least smooth points, given by `worst`, from half-way between voxels.
    /// Returns the smallest slack of a bound, relative to the radius.
    fn check_around(map: &Voxelmap<'_>, worst: impl Fn(Vec3) -> Vec3) -> f32 {
        let field = map.trilinear();
        let mut tight = f32::INFINITY;
        for z in -4..4 {
            for y in -4..4 {
                for x in -4..4 {
                    for shift in [Vec3::ZERO, Vec3::splat(0.5), Vec3::new(0.5, 0.0, 0.499)] {
                        let center = Vec3::new(x as f32, y as f32, z as f32) + shift;
                        let point = worst(center);
                        let radius = center.distance(point);
                        if radius == 0.0 || radius > 6.0 {
                            continue;
                        }
                        let inside = (point - center) / radius;
                        let turn = Quat::from_axis_angle(Vec3::Y, 0.4);
                        for normal in [inside, inside.any_orthonormal_vector(), turn * inside] {
                            check(&field, center, radius, inside, normal).unwrap();
                        }
                        let over = field.penetration_bound(center, radius)
                            - field.penetration(point, Vec3::Y);
                        tight = tight.min(over / radius);
                    }
                }
            }
        }
        tight
    }

    /// The distance to the centre of one voxel: interpolation around it is as steep as possible.
    #[test]
    fn a_point_is_bounded() {
        let at = Vec3::splat(0.5);
        assert!(check_around(&map_of(|p| -p.distance(at)), |_| at) < 0.2);
    }

    /// Two half-spaces that meet: across the groove the field curves as much as possible.
    #[test]
    fn a_groove_is_bounded() {
        for normal in [
            Vec3::X,
            Vec3::new(1.0, 1.0, 0.0),
            Vec3::ONE,
            Vec3::new(1.0, 0.3, -0.2),
        ] {
            let normal = normal.normalize();
            let map = map_of(|p| p.dot(normal).abs() - 3.0);
            for further in [0.1, 0.5, 1.0, 2.0, 4.0] {
                check_around(&map, |center| {
                    let to_groove = -center.dot(normal);
                    center + normal * (to_groove + to_groove.signum() * further)
                });
            }
        }
    }

    /// Outside of the grid a field falls with the distance, even one that is steeper inside.
    #[test]
    fn a_steep_field_is_bounded_outside_of_its_grid() {
        for slope in [1.5 * Vec3::X, Vec3::ONE, Vec3::new(0.9, 0.8, 0.1)] {
            let map = map_of(|p| p.dot(slope));
            // No distance field is so steep: only the stored values are known.
            let error_bounds = ErrorBounds {
                in_band: 100.0,
                beyond: 100.0,
                narrow_band: 100.0,
            };
            let map = Voxelmap::from_parts(VoxelmapParts {
                grid: *map.grid(),
                sigma: 1.0,
                solid: map.solid(),
                error_bounds,
                store: map.store().clone(),
                curvature_bounds: map.curvature_bounds().to_vec().into(),
            })
            .unwrap();
            let down = -slope.normalize();
            for x in [-11.0, -11.5, -13.0] {
                let center = Vec3::new(x, -10.9, 3.0);
                for inside in [down, Vec3::NEG_X, Vec3::new(-0.5, 0.3, 0.8), Vec3::X] {
                    for normal in [down, down.any_orthonormal_vector()] {
                        check(&map.trilinear(), center, 4.0, inside, normal).unwrap();
                    }
                }
            }
        }
    }

    #[test]
    fn a_planar_field_has_no_curvature() {
        let slope = Vec3::new(0.25, -0.5, 0.125);
        let map = map_of(|p| p.dot(slope));
        assert!(map.curvature_bounds().iter().all(|&b| b == 0));
        // So a disc across the slope has no more than its centre.
        let normal = slope.normalize();
        check(
            &map.trilinear(),
            Vec3::ONE,
            3.0,
            normal.any_orthonormal_vector(),
            normal,
        )
        .unwrap();
        let discs = Discs {
            half_thicknesses: [0.0; 4],
            normals: Points::splat(normal),
            ..Discs::balls(&Points::splat(Vec3::ONE), [3.0; 4])
        };
        let bound = map.trilinear().penetration_bounds(&discs)[0];
        assert!((bound - Vec3::ONE.dot(slope)).abs() < 1e-4);
    }
}
