//! Closing holes and cracks of a surface by ear clipping.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use glamx::DVec3;
use rustc_hash::FxHashMap;

use crate::mesh::edges::Edges;
use crate::mesh::triangle::normal;

/// Triangles that close all holes of a surface, and the number of holes.
///
/// A boundary loop is closed by ears, the sharpest corner first. A crack runs along one side and
/// back along the other, so its ends are sharpest and it is zipped up. A wide hole is covered from
/// its boundary inwards. No vertex is added.
pub(super) fn fill(vertices: &[DVec3], triangles: &[[u32; 3]]) -> (usize, Vec<[u32; 3]>) {
    let boundary_loops = boundary_loops(vertices, triangles);
    let count = boundary_loops.len();
    let mut filling = Vec::new();
    for rim in boundary_loops {
        rim.close(&mut filling);
    }
    (count, filling)
}

/// An edge of a boundary loop, opposite to its direction in the surface.
#[derive(Clone, Copy)]
struct BoundaryEdge {
    from: u32,
    to: u32,
    /// Unit normal of the adjacent triangle.
    normal: DVec3,
}

/// Edges that are used more often in one direction than in the other.
fn boundary_edges(vertices: &[DVec3], triangles: &[[u32; 3]]) -> Vec<BoundaryEdge> {
    let mut open = Vec::new();
    for uses in Edges::of(triangles).groups() {
        let excess = Edges::excess(uses);
        let (low, high) = uses[0].between;
        let (from, to) = if excess > 0 { (high, low) } else { (low, high) };
        let unmatched = uses.iter().filter(|e| e.forward == (excess > 0));
        for edge in unmatched.take(excess.unsigned_abs() as usize) {
            let corners = triangles[edge.triangle as usize];
            let normal = normal(corners.map(|v| vertices[v as usize]));
            open.push(BoundaryEdge { from, to, normal });
        }
    }
    open
}

/// The boundary loops of all holes. Where several edges leave a vertex, a loop follows the one at
/// the sharpest corner, so that the area between the two belongs to the hole.
fn boundary_loops<'v>(vertices: &'v [DVec3], triangles: &[[u32; 3]]) -> Vec<BoundaryLoop<'v>> {
    let open = boundary_edges(vertices, triangles);
    let mut leaving: FxHashMap<u32, Vec<usize>> = FxHashMap::default();
    for (i, edge) in open.iter().enumerate() {
        leaving.entry(edge.from).or_default().push(i);
    }
    let position = |v: u32| vertices[v as usize];
    let corner = |into: &BoundaryEdge, out: &BoundaryEdge| {
        let up = into.normal + out.normal;
        interior_angle(position(into.from), position(into.to), position(out.to), up)
    };
    let mut is_used = vec![false; open.len()];
    let mut boundary_loops = Vec::new();
    for first in 0..open.len() {
        if is_used[first] {
            continue;
        }
        let mut path = vec![open[first]];
        is_used[first] = true;
        // A boundary is closed: each vertex is left as often as it is reached.
        loop {
            let last = path[path.len() - 1];
            let leaving_here = leaving.get(&last.to).into_iter().flatten().copied();
            let free = leaving_here.filter(|&i| i == first || !is_used[i]);
            let next =
                free.min_by(|&a, &b| corner(&last, &open[a]).total_cmp(&corner(&last, &open[b])));
            match next {
                Some(next) if next != first => {
                    is_used[next] = true;
                    path.push(open[next]);
                }
                _ => break,
            }
        }
        boundary_loops.push(BoundaryLoop::new(vertices, &path));
    }
    boundary_loops
}

/// The boundary loop of one hole, during ear clipping.
struct BoundaryLoop<'v> {
    positions: &'v [DVec3],
    vertices: Vec<u32>,
    /// Unit normals of the surface along the edge from each corner to the next.
    normals: Vec<DVec3>,
    next: Vec<usize>,
    previous: Vec<usize>,
    /// Version of each corner, to skip stale heap entries.
    version: Vec<u32>,
}

impl<'v> BoundaryLoop<'v> {
    fn new(positions: &'v [DVec3], edges: &[BoundaryEdge]) -> Self {
        let count = edges.len();
        Self {
            positions,
            vertices: edges.iter().map(|e| e.from).collect(),
            normals: edges.iter().map(|e| e.normal).collect(),
            next: (0..count).map(|i| (i + 1) % count).collect(),
            previous: (0..count).map(|i| (i + count - 1) % count).collect(),
            version: vec![0; count],
        }
    }

    fn close(mut self, filling: &mut Vec<[u32; 3]>) {
        let mut left = self.vertices.len();
        // Non-negative floats order as their bits.
        let entry = |rim: &Self, i: usize| Reverse((rim.angle(i).to_bits(), i, rim.version[i]));
        let mut corners: BinaryHeap<_> = (0..left).map(|i| entry(&self, i)).collect();
        while left >= 3 {
            let Some(Reverse((_, i, version))) = corners.pop() else {
                break;
            };
            if version != self.version[i] {
                continue;
            }
            let (before, after) = (self.previous[i], self.next[i]);
            let ear = [before, i, after].map(|c| self.vertices[c]);
            left -= 1;
            // The two edges cancel.
            if ear[0] == ear[2] {
                let behind = self.next[after];
                self.version[i] += 1;
                self.version[after] += 1;
                left -= 1;
                self.next[before] = behind;
                self.previous[behind] = before;
                self.normals[before] = self.normals[after];
                for corner in [before, behind] {
                    self.version[corner] += 1;
                    corners.push(entry(&self, corner));
                }
                continue;
            }
            filling.push(ear);
            if left < 3 {
                break;
            }
            let across = normal(ear.map(|v| self.positions[v as usize]));
            if across != DVec3::ZERO {
                self.normals[before] = across;
            }
            self.next[before] = after;
            self.previous[after] = before;
            self.version[i] += 1;
            for corner in [before, after] {
                self.version[corner] += 1;
                corners.push(entry(&self, corner));
            }
        }
    }

    fn angle(&self, corner: usize) -> f64 {
        let position = |i: usize| self.positions[self.vertices[i] as usize];
        let (previous, next) = (self.previous[corner], self.next[corner]);
        let up = self.normals[previous] + self.normals[corner];
        interior_angle(position(previous), position(corner), position(next), up)
    }
}

/// The interior angle of a hole at a corner, from 0 to 2 π, seen from the front.
fn interior_angle(previous: DVec3, corner: DVec3, next: DVec3, up: DVec3) -> f64 {
    let (to_previous, to_next) = (previous - corner, next - corner);
    let (cross, dot) = (to_next.cross(to_previous), to_next.dot(to_previous));
    let angle = cross.length().copysign(up.dot(cross)).atan2(dot);
    if angle < 0.0 {
        angle + std::f64::consts::TAU
    } else {
        // Adding 0 avoids -0, whose bits are large.
        angle + 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Mesh;
    use crate::mesh::triangle::{area, signed_volume};

    fn closed_volume(vertices: &[DVec3], triangles: &[[u32; 3]]) -> (usize, f64) {
        let (holes, filling) = fill(vertices, triangles);
        let all: Vec<_> = triangles.iter().copied().chain(filling).collect();
        assert_eq!(Edges::of(&all).open_count(), 0);
        let corners = |t: &[u32; 3]| t.map(|v| vertices[v as usize]);
        let volume = all.iter().map(|t| signed_volume(corners(t), DVec3::ZERO));
        (holes, volume.sum())
    }

    #[test]
    fn missing_faces_of_a_box_are_put_back() {
        let mesh = Mesh::cuboid([1.0, 2.0, 3.0]).unwrap();
        // One face, and two that only meet at a corner.
        for gone in [vec![0, 1], vec![0, 1, 2, 3], vec![4], vec![4, 7]] {
            let left = (0..12).filter(|t| !gone.contains(t));
            let left: Vec<_> = left.map(|t| mesh.triangles()[t]).collect();
            let (holes, volume) = closed_volume(mesh.vertices(), &left);
            assert!(holes >= 1);
            assert!((volume - 6.0).abs() < 1e-12, "{gone:?}: {volume}");
        }
    }

    /// A notched hole in a plane is covered exactly, from any first corner.
    #[test]
    fn a_concave_hole_in_a_plane_keeps_the_volume() {
        let outline = [
            [1.0, 3.0],
            [0.0, 3.0],
            [0.0, 0.0],
            [4.0, 0.0],
            [4.0, 3.0],
            [3.0, 3.0],
            [3.0, 1.0],
            [1.0, 1.0],
        ];
        let n = outline.len() as u32;
        let mut vertices: Vec<_> = [0.0, 2.0]
            .iter()
            .flat_map(|&z| outline.iter().map(move |&[x, y]| DVec3::new(x, y, z)))
            .collect();
        vertices.push(DVec3::new(2.0, 0.5, 0.0));
        // The bottom is a cone to a point that sees all corners. The top is missing.
        let mut triangles = Vec::new();
        for i in 0..n {
            let j = (i + 1) % n;
            triangles.extend([[i, j, j + n], [i, j + n, i + n], [j, i, 2 * n]]);
        }
        let (holes, volume) = closed_volume(&vertices, &triangles);
        assert_eq!(holes, 1);
        assert!((volume - 16.0).abs() < 1e-12, "{volume}");
    }

    /// A ball cut along its equator, its upper half lifted slightly except for one shared vertex.
    /// The crack is zipped up, and no filling leads inside.
    #[test]
    fn a_crack_is_zipped_up() {
        let ball = Mesh::icosphere(1.0, 4).unwrap();
        let mut vertices = ball.vertices().to_vec();
        let is_upper = |t: &[u32; 3]| t.iter().map(|&v| vertices[v as usize].z).sum::<f64>() > 0.0;
        let uppers: Vec<bool> = ball.triangles().iter().map(is_upper).collect();
        let mut triangles = ball.triangles().to_vec();
        let mut lifted: FxHashMap<u32, u32> = FxHashMap::default();
        let lower_vertices: Vec<u32> = triangles
            .iter()
            .zip(&uppers)
            .filter(|(_, u)| !**u)
            .flat_map(|(t, _)| *t)
            .collect();
        let mut shared = None;
        for (triangle, _) in triangles.iter_mut().zip(&uppers).filter(|(_, u)| **u) {
            for v in triangle {
                if !lower_vertices.contains(v) || *shared.get_or_insert(*v) == *v {
                    continue;
                }
                *v = *lifted.entry(*v).or_insert_with(|| {
                    vertices.push(vertices[*v as usize] + DVec3::Z * 1e-5);
                    vertices.len() as u32 - 1
                });
            }
        }
        let (holes, filling) = fill(&vertices, &triangles);
        assert_eq!(holes, 1);
        let corners = |t: &[u32; 3]| t.map(|v| vertices[v as usize]);
        for [a, b, c] in filling.iter().map(corners) {
            assert!((a + b + c).length() / 3.0 > 0.99);
            assert!(area([a, b, c]) < 0.5e-5);
        }
    }
}
