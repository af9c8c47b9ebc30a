//! Where each voxel lies (section 2.1.1): on the surface, by triangle-box overlap; inside or
//! outside, by winding numbers or by a scan-line fill.

use std::sync::atomic::{AtomicBool, Ordering};

use glamx::{DVec3, I64Vec3};
use rayon::prelude::*;
use vps_core::Grid;

use crate::winding::windings;
use crate::{Mesh, sat};

/// Where a voxel lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Place {
    /// Shares a point with a triangle: v = 0.
    Surface,
    /// v > 0.
    Inside,
    /// v < 0.
    Outside,
}

/// The places of all voxels. Only those around the box of the mesh are stored.
pub(crate) struct Places {
    grid: Grid,
    low: [u32; 3],
    dims: [u32; 3],
    places: Vec<Place>,
    /// Whether the centre of a voxel is in the solid. A fill does not know it for the surface.
    inside: Vec<bool>,
}

impl Places {
    /// By the winding numbers of a closed mesh: the solid is where they are positive. Says, too,
    /// whether they are nowhere other than 0 and 1.
    pub(crate) fn by_winding(mesh: &Mesh, grid: &Grid) -> (Self, bool) {
        let mut places = Self::outside(mesh, grid);
        let centers = |axis: usize| -> Vec<f64> {
            let center = |c| {
                let mut voxel = places.low;
                voxel[axis] += c;
                f64::from(grid.center(voxel)[axis])
            };
            (0..places.dims[axis]).map(center).collect()
        };
        let (x, y, z) = (centers(0), centers(1), centers(2));
        let windings = windings(mesh, [&x, &y, &z]);
        let is_simple = windings.iter().all(|w| (0..=1).contains(w));
        places.inside = windings.iter().map(|&w| w > 0).collect();
        (places.with_surface(mesh), is_simple)
    }

    /// By generalised winding numbers: the solid is where they are above one half. Says, too,
    /// whether they are nowhere above one and a half.
    pub(crate) fn by_generalized_winding(
        mesh: &Mesh,
        grid: &Grid,
        winding: impl Fn(DVec3) -> f64 + Sync,
    ) -> (Self, bool) {
        let mut places = Self::outside(mesh, grid);
        let count = places.inside.len();
        let windings: Vec<f64> = (0..count)
            .into_par_iter()
            .map(|i| winding(grid.center(places.voxel(i)).as_dvec3()))
            .collect();
        let is_simple = windings.iter().all(|&w| w < 1.5);
        places.inside = windings.iter().map(|&w| w > 0.5).collect();
        (places.with_surface(mesh), is_simple)
    }

    /// By a fill from outside through faces of voxels free of triangles. What it does not reach is
    /// inside.
    pub(crate) fn by_fill(mesh: &Mesh, grid: &Grid) -> Self {
        let mut places = Self::outside(mesh, grid);
        places.inside.fill(true);
        let mut places = places.with_surface(mesh);
        fill_outside(places.dims, &mut places.places);
        let is_inside = |&place: &Place| place == Place::Inside;
        places.inside = places.places.iter().map(is_inside).collect();
        places
    }

    /// Everything outside, for a region one voxel larger than the box of the mesh.
    fn outside(mesh: &Mesh, grid: &Grid) -> Self {
        let (low, high) = mesh.bounds();
        let last = grid.dims().map(|n| n - 1);
        let low = grid.voxel_at(low.as_vec3()).map(|c| c.saturating_sub(1));
        let high = grid.voxel_at(high.as_vec3());
        let dims = [0, 1, 2].map(|a| (high[a] + 1).min(last[a]) - low[a] + 1);
        let count = dims.iter().map(|&n| n as usize).product();
        Self {
            grid: *grid,
            low,
            dims,
            places: vec![Place::Outside; count],
            inside: vec![false; count],
        }
    }

    /// The same solid with the triangles of `mesh` as its surface.
    pub(crate) fn with_surface(mut self, mesh: &Mesh) -> Self {
        for (place, inside) in self.places.iter_mut().zip(&self.inside) {
            *place = if *inside {
                Place::Inside
            } else {
                Place::Outside
            };
        }
        let origin = self.grid.origin().as_dvec3();
        let size = f64::from(self.grid.voxel_size());
        let touched: Vec<_> = self.places.iter().map(|_| AtomicBool::new(false)).collect();
        (0..mesh.triangles().len()).into_par_iter().for_each(|t| {
            for_each_overlapped(mesh.corners(t), origin, size, |cell, _| {
                let voxel = cell.map(|c| u32::try_from(c).unwrap_or(u32::MAX));
                if let Some(i) = self.index(voxel) {
                    touched[i].store(true, Ordering::Relaxed);
                }
            });
        });
        for (place, touched) in self.places.iter_mut().zip(touched) {
            if touched.into_inner() {
                *place = Place::Surface;
            }
        }
        self
    }

    pub(crate) fn of(&self, voxel: [u32; 3]) -> Place {
        self.index(voxel).map_or(Place::Outside, |i| self.places[i])
    }

    pub(crate) fn of_point(&self, point: DVec3) -> Place {
        let at = (point - self.grid.origin().as_dvec3()) / f64::from(self.grid.voxel_size());
        if at.min_element() < 0.0 {
            return Place::Outside;
        }
        self.of(at.to_array().map(|c| c as u32))
    }

    /// Whether the centre of a voxel lies in the solid.
    pub(crate) fn is_inside(&self, voxel: [u32; 3]) -> bool {
        self.index(voxel).is_some_and(|i| self.inside[i])
    }

    /// Whether a voxel that no triangle touches is in the solid.
    pub(crate) fn have_interior(&self) -> bool {
        self.places.contains(&Place::Inside)
    }

    /// The n-th of the voxels that are stored.
    fn voxel(&self, n: usize) -> [u32; 3] {
        let [nx, ny, _] = self.dims.map(|n| n as usize);
        let local = [n % nx, n / nx % ny, n / (nx * ny)];
        [0, 1, 2].map(|a| self.low[a] + local[a] as u32)
    }

    fn index(&self, voxel: [u32; 3]) -> Option<usize> {
        let local = [0, 1, 2].map(|a| voxel[a].wrapping_sub(self.low[a]));
        let is_near = (0..3).all(|a| local[a] < self.dims[a]);
        let [x, y, z] = local.map(|c| c as usize);
        let [nx, ny, _] = self.dims.map(|n| n as usize);
        is_near.then(|| (z * ny + y) * nx + x)
    }
}

/// Calls `visit` with every cell of a cubical lattice that shares a point with the triangle, and
/// with the cell's centre. Takes time for those cells, not for all in the box of the triangle.
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
    let steps = high - low;
    // What lies in one row of cells passes through all between its ends.
    if steps.to_array().into_iter().filter(|&n| n > 0).count() <= 1 {
        for i in 0..=steps.max_element() {
            let cell = (low + i).min(high);
            visit(cell.to_array(), origin + (cell.as_dvec3() + 0.5) * size);
        }
        return;
    }
    // Cubes of 2^level cells that share a point with the triangle, in halves.
    let level = (steps.max_element() as u64 + 1)
        .next_power_of_two()
        .trailing_zeros();
    let mut cubes = vec![(low, level)];
    while let Some((first, level)) = cubes.pop() {
        let cells = (1_i64 << level) as f64;
        let center = origin + (first.as_dvec3() + 0.5 * cells) * size;
        if first.cmpgt(high).any() || !sat::overlaps(triangle, center, 0.5 * cells * size) {
            continue;
        }
        if level == 0 {
            visit(first.to_array(), center);
            continue;
        }
        let half = 1_i64 << (level - 1);
        cubes.extend((0..8_i64).rev().map(|i| {
            let step = I64Vec3::new(i & 1, i >> 1 & 1, i >> 2 & 1) * half;
            (first + step, level - 1)
        }));
    }
}

/// Marks what can be reached from the border through faces of voxels that are not surface: run by
/// run along x, so that the stack stays small (after Kaufman and Shimony, 1986).
fn fill_outside(dims: [u32; 3], places: &mut [Place]) {
    let [nx, ny, nz] = dims.map(|n| n as usize);
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

/// The steps to the 26 cells around one, those that share a face first.
pub(crate) const AROUND: [[i32; 3]; 26] = around();

const fn around() -> [[i32; 3]; 26] {
    let mut steps = [[0; 3]; 26];
    let (mut filled, mut shared) = (0, 1);
    while shared <= 3 {
        let mut i = 0;
        while i < 27 {
            let step = [i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1];
            let length = step[0] * step[0] + step[1] * step[1] + step[2] * step[2];
            if length == shared {
                steps[filled] = step;
                filled += 1;
            }
            i += 1;
        }
        shared += 1;
    }
    steps
}

#[cfg(test)]
mod tests {
    use vps_core::Vec3;

    use super::*;

    /// In the order of the descent, and as by looking at each cell of the box.
    #[test]
    fn the_cells_of_a_triangle_are_found() {
        let place = |seed: f64| {
            DVec3::new(
                (seed * 12.9).sin(),
                (seed * 78.2).sin(),
                (seed * 37.7).sin(),
            ) * 6.0
        };
        for i in 0..200 {
            let t = f64::from(i) * 3.0;
            let mut triangle = [place(t), place(t + 1.0), place(t + 2.0)];
            if i % 4 == 0 {
                // A needle.
                triangle[2] = triangle[0].lerp(triangle[1], 0.3);
            }
            let (origin, size) = (DVec3::splat(-7.0), 0.5);
            let mut found = Vec::new();
            for_each_overlapped(triangle, origin, size, |cell, center| {
                assert!(
                    center.distance(origin + (I64Vec3::from(cell).as_dvec3() + 0.5) * size) < 1e-12
                );
                found.push(cell);
            });
            let mut expected = Vec::new();
            for z in 0..28 {
                for y in 0..28 {
                    for x in 0..28 {
                        let center = origin + (I64Vec3::new(x, y, z).as_dvec3() + 0.5) * size;
                        if sat::overlaps(triangle, center, 0.5 * size) {
                            expected.push([x, y, z]);
                        }
                    }
                }
            }
            found.sort_unstable();
            expected.sort_unstable();
            assert_eq!(found, expected);
        }
    }

    /// The corner of the mesh marks the corner of the grid, where a fill might have started.
    #[test]
    fn a_mesh_in_the_corner_of_its_box_is_filled_right() {
        let v = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z].map(|v| v * 8.0);
        let mesh = Mesh::new(&v, &[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]).unwrap();
        let grid = Grid::new(Vec3::splat(-1.0), 1.0, [10, 10, 10]).unwrap();
        let places = Places::by_fill(&mesh, &grid);
        let at = |x, y, z| places.of([x, y, z]);
        assert_eq!(at(0, 0, 0), Place::Surface);
        assert_eq!(at(3, 2, 2), Place::Inside);
        for outside in [(9, 9, 9), (0, 9, 9), (9, 0, 9), (9, 9, 0), (5, 6, 7)] {
            assert_eq!(at(outside.0, outside.1, outside.2), Place::Outside);
        }
    }

    /// Both ways agree on a solid without cavities, and differ on one with.
    #[test]
    fn a_cavity_is_outside_by_winding_and_inside_by_fill() {
        let ball = Mesh::icosphere(0.5, 3).unwrap();
        let grid = Grid::new(Vec3::splat(-0.625), 0.05, [25, 25, 25]).unwrap();
        let small = ball.vertices().iter().map(|&v| v * 0.5);
        let vertices: Vec<_> = ball.vertices().iter().copied().chain(small).collect();
        let inner = ball.triangles().iter().map(|t| {
            let [a, b, c] = t.map(|v| v + ball.vertices().len() as u32);
            [a, c, b]
        });
        let triangles: Vec<_> = ball.triangles().iter().copied().chain(inner).collect();
        let hollow = Mesh::new(&vertices, &triangles).unwrap();
        let (winding, is_simple) = Places::by_winding(&hollow, &grid);
        assert!(is_simple);
        let fill = Places::by_fill(&hollow, &grid);
        let middle = [12; 3];
        assert_eq!(
            (winding.of(middle), fill.of(middle)),
            (Place::Outside, Place::Inside)
        );
        let (solid, _) = Places::by_winding(&ball, &grid);
        let filled = Places::by_fill(&ball, &grid);
        for x in 0..25 {
            for y in 0..25 {
                for z in 0..25 {
                    assert_eq!(solid.of([x, y, z]), filled.of([x, y, z]), "{x} {y} {z}");
                }
            }
        }
    }
}
