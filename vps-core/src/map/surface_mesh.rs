//! The surface of a voxelmap as a mesh, for display.

use alloc::vec::Vec;

use glamx::Vec3;

use crate::map::voxelmap::Voxelmap;

/// Quadrilaterals over vertices in metres, in the frame of the map, counter-clockwise seen from
/// outside. They need not be planar.
///
/// ```
/// use vps_core::{Ball, Grid, Vec3, Voxelmap};
///
/// let grid = Grid::new(Vec3::splat(-0.15), 0.01, [30; 3])?;
/// let mesh = Voxelmap::of_field(grid, &Ball::new(0.1))?.surface_mesh();
/// assert!(mesh.vertices.iter().all(|v| (v.length() - 0.1).abs() < 1e-3));
/// assert_eq!(mesh.triangles().count(), 2 * mesh.squares.len());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SurfaceMesh {
    /// In metres.
    pub vertices: Vec<Vec3>,
    /// Four vertices each.
    pub squares: Vec<[u32; 4]>,
}

impl SurfaceMesh {
    /// Each quadrilateral as two triangles.
    pub fn triangles(&self) -> impl Iterator<Item = [u32; 3]> {
        let halves = |&[a, b, c, d]: &[u32; 4]| [[a, b, c], [a, c, d]];
        self.squares.iter().flat_map(halves)
    }

    /// The edges of the quadrilaterals, each once.
    pub fn edges(&self) -> Vec<[u32; 2]> {
        let around = |&[a, b, c, d]: &[u32; 4]| [[a, b], [b, c], [c, d], [d, a]];
        let edges = self.squares.iter().flat_map(around);
        let mut edges: Vec<_> = edges.map(|[a, b]| [a.min(b), a.max(b)]).collect();
        edges.sort_unstable();
        edges.dedup();
        edges
    }
}

/// Index of a missing vertex.
const NO_VERTEX: u32 = u32::MAX;

impl Voxelmap<'_> {
    /// The zero level set by surface nets: a vertex in every cell of eight voxel centres with both
    /// signs, and a quadrilateral across every edge between two centres that differ in sign. Visits
    /// all voxels.
    pub fn surface_mesh(&self) -> SurfaceMesh {
        let grid = self.grid();
        let [nx, ny, nz] = grid.dims();
        let mut mesh = SurfaceMesh::default();
        // Vertices of two layers of cells.
        let layer = || alloc::vec![NO_VERTEX; nx as usize * ny as usize];
        let (mut below, mut here) = (layer(), layer());
        let at = |x: u32, y: u32| y as usize * nx as usize + x as usize;
        for z in 0..nz.saturating_sub(1) {
            for y in 0..ny.saturating_sub(1) {
                for x in 0..nx.saturating_sub(1) {
                    let vertex = self.vertex_in_cell([x, y, z]);
                    here[at(x, y)] = vertex.map_or(NO_VERTEX, |vertex| {
                        mesh.vertices.push(vertex);
                        mesh.vertices.len() as u32 - 1
                    });
                }
            }
            // Edges along x and y lie between this layer of cells and the one below, edges along z
            // within it.
            for y in 0..ny.saturating_sub(1) {
                for x in 0..nx.saturating_sub(1) {
                    let cells = |[dx, dy]: [u32; 2], layer: &[u32]| {
                        let is_there = x >= dx && y >= dy;
                        if is_there {
                            layer[at(x - dx, y - dy)]
                        } else {
                            NO_VERTEX
                        }
                    };
                    let around = [
                        [
                            cells([0, 1], &below),
                            cells([0, 0], &below),
                            cells([0, 0], &here),
                            cells([0, 1], &here),
                        ],
                        [
                            cells([0, 0], &below),
                            cells([1, 0], &below),
                            cells([1, 0], &here),
                            cells([0, 0], &here),
                        ],
                        [
                            cells([1, 1], &here),
                            cells([0, 1], &here),
                            cells([0, 0], &here),
                            cells([1, 0], &here),
                        ],
                    ];
                    for (axis, mut square) in around.into_iter().enumerate() {
                        if square.contains(&NO_VERTEX) {
                            continue;
                        }
                        let mut end = [x, y, z];
                        end[axis] += 1;
                        let [inside, other] =
                            [[x, y, z], end].map(|v| self.center_penetration(v) > 0.0);
                        if inside == other {
                            continue;
                        }
                        if !inside {
                            square.reverse();
                        }
                        mesh.squares.push(square);
                    }
                }
            }
            core::mem::swap(&mut below, &mut here);
        }
        mesh
    }

    /// The mean of the zero crossings along the edges of a cell, whose first corner is the centre of a
    /// voxel.
    fn vertex_in_cell(&self, [x, y, z]: [u32; 3]) -> Option<Vec3> {
        let corner = |i: u32| [x + (i & 1), y + (i >> 1 & 1), z + (i >> 2 & 1)];
        let values = [0, 1, 2, 3, 4, 5, 6, 7].map(|i| self.center_penetration(corner(i)));
        let (mut sum, mut crossings) = (Vec3::ZERO, 0_u8);
        for i in 0..8_u32 {
            for bit in [1, 2, 4] {
                let j = i | bit;
                let (a, b) = (values[i as usize], values[j as usize]);
                if j != i && (a > 0.0) != (b > 0.0) {
                    let (from, to) = (self.grid().center(corner(i)), self.grid().center(corner(j)));
                    sum += from + (to - from) * (a / (a - b));
                    crossings += 1;
                }
            }
        }
        (crossings > 0).then(|| sum / f32::from(crossings))
    }
}
