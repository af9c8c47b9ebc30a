//! Classification of voxels (section 2.1.1): surface, by triangle-box overlap; inside or outside,
//! by winding numbers or by a scan-line flood fill.

use std::sync::atomic::{AtomicBool, Ordering};

use glamx::DVec3;
use rayon::prelude::*;
use vps_core::Grid;

use super::winding::winding_numbers;
use crate::mesh::Mesh;
use crate::spatial::lattice::for_each_overlapped_cell;

/// The class of a voxel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum VoxelClass {
    /// Shares a point with a triangle: v = 0.
    Surface,
    /// v > 0.
    Inside,
    /// v < 0.
    Outside,
}

/// The classes of all voxels. Only those around the box of the mesh are stored.
pub(crate) struct VoxelClasses {
    grid: Grid,
    low: [u32; 3],
    dims: [u32; 3],
    stored: Vec<VoxelClass>,
    /// Whether the centre of a voxel is in the solid. Unknown to a fill for surface voxels.
    inside: Vec<bool>,
}

impl VoxelClasses {
    /// By the winding numbers of a closed mesh: the solid is where they are positive. Also returns
    /// whether all of them are 0 or 1.
    pub(crate) fn by_winding(mesh: &Mesh, grid: &Grid) -> (Self, bool) {
        let mut classes = Self::outside(mesh, grid);
        let centers = |axis: usize| -> Vec<f64> {
            let center = |c| {
                let mut voxel = classes.low;
                voxel[axis] += c;
                f64::from(grid.center(voxel)[axis])
            };
            (0..classes.dims[axis]).map(center).collect()
        };
        let (x, y, z) = (centers(0), centers(1), centers(2));
        let windings = winding_numbers(mesh, [&x, &y, &z]);
        let is_simple = windings.iter().all(|w| (0..=1).contains(w));
        classes.inside = windings.iter().map(|&w| w > 0).collect();
        (classes.with_surface(mesh), is_simple)
    }

    /// By generalised winding numbers: the solid is where they exceed 1/2. Also returns whether all
    /// of them are below 3/2.
    pub(crate) fn by_generalized_winding(
        mesh: &Mesh,
        grid: &Grid,
        winding: impl Fn(DVec3) -> f64 + Sync,
    ) -> (Self, bool) {
        let mut classes = Self::outside(mesh, grid);
        let count = classes.inside.len();
        let windings: Vec<f64> = (0..count)
            .into_par_iter()
            .map(|i| winding(grid.center(classes.voxel(i)).as_dvec3()))
            .collect();
        let is_simple = windings.iter().all(|&w| w < 1.5);
        classes.inside = windings.iter().map(|&w| w > 0.5).collect();
        (classes.with_surface(mesh), is_simple)
    }

    /// By a flood fill from outside through voxels without triangles. Voxels it does not reach are
    /// inside.
    pub(crate) fn by_fill(mesh: &Mesh, grid: &Grid) -> Self {
        let mut classes = Self::outside(mesh, grid);
        classes.inside.fill(true);
        let mut classes = classes.with_surface(mesh);
        flood_fill_outside(classes.dims, &mut classes.stored);
        let is_inside = |&class: &VoxelClass| class == VoxelClass::Inside;
        classes.inside = classes.stored.iter().map(is_inside).collect();
        classes
    }

    /// All outside, for a region one voxel larger than the box of the mesh.
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
            stored: vec![VoxelClass::Outside; count],
            inside: vec![false; count],
        }
    }

    /// The same solid with the triangles of `mesh` as its surface.
    pub(crate) fn with_surface(mut self, mesh: &Mesh) -> Self {
        for (class, inside) in self.stored.iter_mut().zip(&self.inside) {
            *class = if *inside {
                VoxelClass::Inside
            } else {
                VoxelClass::Outside
            };
        }
        let origin = self.grid.origin().as_dvec3();
        let size = f64::from(self.grid.voxel_size());
        let touched: Vec<_> = self.stored.iter().map(|_| AtomicBool::new(false)).collect();
        (0..mesh.triangles().len()).into_par_iter().for_each(|t| {
            for_each_overlapped_cell(mesh.corners(t), origin, size, |cell, _| {
                let voxel = cell.map(|c| u32::try_from(c).unwrap_or(u32::MAX));
                if let Some(i) = self.index(voxel) {
                    touched[i].store(true, Ordering::Relaxed);
                }
            });
        });
        for (class, touched) in self.stored.iter_mut().zip(touched) {
            if touched.into_inner() {
                *class = VoxelClass::Surface;
            }
        }
        self
    }

    /// The class of a voxel.
    pub(crate) fn of(&self, voxel: [u32; 3]) -> VoxelClass {
        self.index(voxel)
            .map_or(VoxelClass::Outside, |i| self.stored[i])
    }

    /// The class of the voxel that holds a point.
    pub(crate) fn of_point(&self, point: DVec3) -> VoxelClass {
        let at = (point - self.grid.origin().as_dvec3()) / f64::from(self.grid.voxel_size());
        if at.min_element() < 0.0 {
            return VoxelClass::Outside;
        }
        self.of(at.to_array().map(|c| c as u32))
    }

    /// Whether the centre of a voxel lies in the solid.
    pub(crate) fn is_inside(&self, voxel: [u32; 3]) -> bool {
        self.index(voxel).is_some_and(|i| self.inside[i])
    }

    /// Whether a voxel off the surface is in the solid.
    pub(crate) fn has_interior(&self) -> bool {
        self.stored.contains(&VoxelClass::Inside)
    }

    /// The n-th stored voxel.
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

/// Flood fill from the border through non-surface voxels. It proceeds in runs along x, so that the
/// stack stays small (after Kaufman and Shimony, 1986).
fn flood_fill_outside(dims: [u32; 3], classes: &mut [VoxelClass]) {
    let [nx, ny, nz] = dims.map(|n| n as usize);
    let mut seeds = Vec::new();
    // A mesh that reaches a corner of its box may cut the border into parts, so all of it is
    // seeded.
    for z in 0..nz {
        for y in 0..ny {
            let whole_row = z == 0 || z + 1 == nz || y == 0 || y + 1 == ny;
            let step = if whole_row { 1 } else { nx.max(2) - 1 };
            seeds.extend((0..nx).step_by(step).map(|x| (x, y, z)));
        }
    }
    while let Some((x, y, z)) = seeds.pop() {
        let row = (z * ny + y) * nx;
        if classes[row + x] != VoxelClass::Inside {
            continue;
        }
        let open = |x: &usize| classes[row + x] == VoxelClass::Inside;
        let start = (0..x).rev().take_while(open).last().unwrap_or(x);
        let end = x + (x..nx).take_while(open).count();
        classes[row + start..row + end].fill(VoxelClass::Outside);
        let neighbours = [
            (y > 0).then(|| (y - 1, z)),
            (y + 1 < ny).then_some((y + 1, z)),
            (z > 0).then(|| (y, z - 1)),
            (z + 1 < nz).then_some((y, z + 1)),
        ];
        for (y, z) in neighbours.into_iter().flatten() {
            let row = &classes[(z * ny + y) * nx..][..nx];
            let mut in_run = false;
            for (x, &class) in row[start..end].iter().enumerate() {
                let fresh = class == VoxelClass::Inside;
                if fresh && !in_run {
                    seeds.push((start + x, y, z));
                }
                in_run = fresh;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use vps_core::Vec3;

    use super::*;

    /// The mesh occupies the corner of the grid, where a single seed would lie.
    #[test]
    fn a_mesh_in_the_corner_of_its_box_is_filled_right() {
        let v = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z].map(|v| v * 8.0);
        let mesh = Mesh::new(&v, &[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]).unwrap();
        let grid = Grid::new(Vec3::splat(-1.0), 1.0, [10, 10, 10]).unwrap();
        let classes = VoxelClasses::by_fill(&mesh, &grid);
        let at = |x, y, z| classes.of([x, y, z]);
        assert_eq!(at(0, 0, 0), VoxelClass::Surface);
        assert_eq!(at(3, 2, 2), VoxelClass::Inside);
        for outside in [(9, 9, 9), (0, 9, 9), (9, 0, 9), (9, 9, 0), (5, 6, 7)] {
            assert_eq!(at(outside.0, outside.1, outside.2), VoxelClass::Outside);
        }
    }

    /// Both classifications agree on a solid without cavities, and differ on one with a cavity.
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
        let (winding, is_simple) = VoxelClasses::by_winding(&hollow, &grid);
        assert!(is_simple);
        let fill = VoxelClasses::by_fill(&hollow, &grid);
        let middle = [12; 3];
        assert_eq!(
            (winding.of(middle), fill.of(middle)),
            (VoxelClass::Outside, VoxelClass::Inside)
        );
        let (solid, _) = VoxelClasses::by_winding(&ball, &grid);
        let filled = VoxelClasses::by_fill(&ball, &grid);
        for x in 0..25 {
            for y in 0..25 {
                for z in 0..25 {
                    assert_eq!(solid.of([x, y, z]), filled.of([x, y, z]), "{x} {y} {z}");
                }
            }
        }
    }
}
