//! Winding numbers around a point, of a closed mesh.
//!
//! They are counted along scanlines parallel to x: each crossing triangle adds or subtracts one.
//! The side of an edge on which a scanline passes is decided exactly. A scanline through an edge or
//! a corner is perturbed, always to the same side. It never slips between two triangles, so the
//! numbers are exact.

use std::borrow::Cow;

use glamx::DVec3;
use robust::{Coord, orient2d};

use crate::mesh::Mesh;

/// The x of the crossing of a triangle with the scanline through (y, z), and the change of the
/// winding number there towards +x.
fn crossing([a, b, c]: [DVec3; 3], [y, z]: [f64; 2]) -> Option<(f64, i32)> {
    let at = Coord { x: y, y: z };
    let flat = |v: DVec3| Coord { x: v.y, y: v.z };
    // Twice the area between the scanline and an edge, the same for both triangles at the edge.
    let side = |from: DVec3, to: DVec3| orient2d(flat(from), flat(to), at);
    let sides = [side(a, b), side(b, c), side(c, a)];
    let sign = |area: f64, from: DVec3, to: DVec3| {
        if area != 0.0 {
            return area > 0.0;
        }
        // Symbolic perturbation: slightly towards +y, and less towards -z.
        let along_y = from.z - to.z;
        if along_y != 0.0 {
            along_y > 0.0
        } else {
            to.y > from.y
        }
    };
    let left = sign(sides[0], a, b);
    if sign(sides[1], b, c) != left || sign(sides[2], c, a) != left {
        return None;
    }
    let total: f64 = sides.iter().sum();
    if total == 0.0 {
        // The triangle is parallel to x.
        return None;
    }
    let x = (sides[1] * a.x + sides[2] * b.x + sides[0] * c.x) / total;
    // Counter-clockwise seen from +x: the scanline leaves the solid.
    Some((x, if left { -1 } else { 1 }))
}

/// The winding numbers at the points (x, y, z) of a lattice, x fastest, then y, then z. The
/// coordinates of each axis must increase.
pub(crate) fn winding_numbers(mesh: &Mesh, [xs, ys, zs]: [&[f64]; 3]) -> Vec<i16> {
    let mut changes = vec![0_i16; xs.len() * ys.len() * zs.len()];
    for t in 0..mesh.triangles().len() {
        let corners = mesh.corners(t);
        let [a, b, c] = corners;
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let range = |along: &[f64], low: f64, high: f64| {
            along.partition_point(|&v| v < low)..along.partition_point(|&v| v <= high)
        };
        for z in range(zs, low.z, high.z) {
            for y in range(ys, low.y, high.y) {
                if let Some((x, change)) = crossing(corners, [ys[y], zs[z]]) {
                    let behind = xs.partition_point(|&v| v <= x);
                    if behind < xs.len() {
                        changes[(z * ys.len() + y) * xs.len() + behind] += change as i16;
                    }
                }
            }
        }
    }
    for row in changes.chunks_mut(xs.len()) {
        let mut winding = 0;
        for change in row {
            winding += *change;
            *change = winding;
        }
    }
    changes
}

/// Triangles in bins of scanlines along x, for winding numbers at single points.
pub(crate) struct ScanlineIndex<'m> {
    mesh: Cow<'m, Mesh>,
    low: DVec3,
    bin: f64,
    /// Bins along y and z.
    dims: [usize; 2],
    /// Start of each bin in `triangles`.
    starts: Vec<u32>,
    triangles: Vec<u32>,
}

impl<'m> ScanlineIndex<'m> {
    pub(crate) fn new(mesh: &'m Mesh) -> Self {
        Self::of(Cow::Borrowed(mesh))
    }

    pub(crate) fn of(mesh: Cow<'m, Mesh>) -> Self {
        let (low, high) = mesh.bounds();
        let extents = high - low;
        let bins_per_side = (mesh.triangles().len() as f64).sqrt().clamp(1.0, 1024.0);
        let bin = extents.y.max(extents.z) / bins_per_side;
        let bins = |length: f64| (length / bin) as usize + 1;
        let dims = [bins(extents.y), bins(extents.z)];
        let count = mesh.triangles().len();
        let mut scanlines = Self {
            mesh,
            low,
            bin,
            dims,
            starts: vec![0; dims[0] * dims[1] + 1],
            triangles: Vec::new(),
        };
        let mut starts = vec![0_u32; scanlines.starts.len()];
        for t in 0..count {
            scanlines.for_each_bin(t, |bin| starts[bin + 1] += 1);
        }
        for i in 1..starts.len() {
            starts[i] += starts[i - 1];
        }
        scanlines.starts.clone_from(&starts);
        let mut triangles = vec![0; starts[starts.len() - 1] as usize];
        for t in 0..count {
            scanlines.for_each_bin(t, |bin| {
                triangles[starts[bin] as usize] = t as u32;
                starts[bin] += 1;
            });
        }
        scanlines.triangles = triangles;
        scanlines
    }

    /// The winding number of the triangles that `counts` selects, around the point.
    pub(crate) fn winding(&self, point: DVec3, counts: impl Fn(u32) -> bool) -> i32 {
        let mut winding = 0;
        self.for_each_crossing(point, |triangle, change| {
            if counts(triangle) {
                winding += change;
            }
        });
        winding
    }

    /// Calls `visit` with each triangle that the scanline from -x to the point crosses, and with
    /// its change of the winding number.
    pub(crate) fn for_each_crossing(&self, point: DVec3, mut visit: impl FnMut(u32, i32)) {
        let [y, z] = self.bin_of(point);
        let bin = z * self.dims[0] + y;
        for &t in &self.triangles[self.starts[bin] as usize..self.starts[bin + 1] as usize] {
            match crossing(self.mesh.corners(t as usize), [point.y, point.z]) {
                Some((x, change)) if x <= point.x => visit(t, change),
                _ => {}
            }
        }
    }

    fn for_each_bin(&self, triangle: usize, mut visit: impl FnMut(usize)) {
        let [a, b, c] = self.mesh.corners(triangle);
        let low = self.bin_of(a.min(b).min(c));
        let high = self.bin_of(a.max(b).max(c));
        for z in low[1]..=high[1] {
            for y in low[0]..=high[0] {
                visit(z * self.dims[0] + y);
            }
        }
    }

    /// The bin of a point, or the closest one.
    fn bin_of(&self, point: DVec3) -> [usize; 2] {
        let at = (point - self.low) / self.bin;
        // Casts saturate.
        [
            (at.y as usize).min(self.dims[0] - 1),
            (at.z as usize).min(self.dims[1] - 1),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A box and an octahedron with corners and edges on the scanlines.
    #[test]
    fn lines_through_corners_and_edges_count_right() {
        let along: Vec<f64> = (-8..=8).map(|i| f64::from(i) * 0.25).collect();
        let axes = [along.as_slice(); 3];
        let boxed = Mesh::cuboid([2.0, 2.0, 2.0]).unwrap();
        let octahedron = {
            let v: Vec<_> = DVec3::AXES.into_iter().flat_map(|a| [a, -a]).collect();
            let mut t = Vec::new();
            for x in [0, 1] {
                for y in [2, 3] {
                    for z in [4, 5] {
                        let odd = (x + y + z) % 2 == 1;
                        t.push(if odd { [x, z, y] } else { [x, y, z] });
                    }
                }
            }
            Mesh::new(&v, &t).unwrap()
        };
        for (mesh, inside) in [
            (
                &boxed,
                (|p| p.abs().max_element() - 1.0) as fn(DVec3) -> f64,
            ),
            (&octahedron, |p| p.abs().element_sum() - 1.0),
        ] {
            let found = winding_numbers(mesh, axes);
            let scanlines = ScanlineIndex::new(mesh);
            let mut i = 0;
            for z in &along {
                for y in &along {
                    for x in &along {
                        let p = DVec3::new(*x, *y, *z);
                        if inside(p) != 0.0 {
                            assert_eq!(found[i] == 1, inside(p) < 0.0, "{p}");
                            assert_eq!(scanlines.winding(p, |_| true), i32::from(found[i]), "{p}");
                        }
                        i += 1;
                    }
                }
            }
            assert!(found.iter().all(|w| (0..=1).contains(w)));
        }
    }

    #[test]
    fn a_mesh_twice_counts_twice_and_turned_inside_out_negative() {
        let ball = Mesh::icosphere(1.0, 2).unwrap();
        let twice = [ball.triangles(), ball.triangles()].concat();
        let turned: Vec<_> = ball
            .triangles()
            .iter()
            .map(|&[a, b, c]| [a, c, b])
            .collect();
        for (triangles, expected) in [(twice, 2), (turned, -1)] {
            let mesh = Mesh::new(ball.vertices(), &triangles).unwrap();
            assert_eq!(winding_numbers(&mesh, [&[0.0], &[0.0], &[0.0]]), [expected]);
            assert_eq!(winding_numbers(&mesh, [&[1.5], &[0.0], &[0.0]]), [0]);
        }
    }
}
