//! The vertices of a surface, split between the bodies that meet there.
//!
//! Where two bodies touch, they share vertices and edges, and more than two triangles meet at an
//! edge. Triangles that bound the same body there are neighbours. A fan is a set of triangles
//! around a vertex connected through neighbours.

use std::f64::consts::TAU;

use glamx::DVec3;

use super::self_contact::are_coincident;
use crate::mesh::Mesh;
use crate::mesh::edges::{Edge, Edges};
use crate::mesh::union_find::UnionFind;

/// The fans of a surface.
pub(super) struct Fans {
    /// The fan of each triangle at each of its corners.
    pub(super) of_triangles: Vec<[u32; 3]>,
    /// The vertex of each fan.
    pub(super) vertices: Vec<u32>,
    /// Whether neighbours are unambiguous: no triangles of the same orientation coincide at a
    /// common edge.
    pub(super) are_unambiguous: bool,
}

/// Number of triangles at an edge beyond which all are joined.
const MOST_AT_EDGE: usize = 64;

impl Fans {
    /// The fans of a closed surface. Triangles that coincide face to face, to within `gap` metres,
    /// are joined only to each other if no others are left.
    pub(super) fn of(surface: &Mesh, gap: f64) -> Self {
        let triangles = surface.triangles();
        let mut corners = UnionFind::new(3 * triangles.len());
        let corner = |edge: &Edge, vertex: u32| {
            let at = triangles[edge.triangle as usize].iter();
            let position = at.take_while(|&&v| v != vertex).count() as u32;
            3 * edge.triangle + position
        };
        let mut join = |a: &Edge, b: &Edge| {
            let (low, high) = a.between;
            for vertex in [low, high] {
                corners.join(corner(a, vertex), corner(b, vertex));
            }
        };
        let mut are_unambiguous = true;
        for uses in Edges::of(triangles).groups() {
            if uses.len() <= 2 || uses.len() > MOST_AT_EDGE {
                uses.windows(2).for_each(|pair| join(&pair[0], &pair[1]));
                continue;
            }
            are_unambiguous &= !some_are_double(surface, uses, gap);
            for (a, b) in neighbours(surface, uses, gap) {
                join(a, b);
            }
        }
        let mut fans = Self {
            of_triangles: vec![[0; 3]; triangles.len()],
            vertices: Vec::new(),
            are_unambiguous,
        };
        let mut numbers = vec![u32::MAX; 3 * triangles.len()];
        for (t, triangle) in triangles.iter().enumerate() {
            for (i, &vertex) in triangle.iter().enumerate() {
                let number = &mut numbers[corners.root((3 * t + i) as u32) as usize];
                if *number == u32::MAX {
                    *number = fans.vertices.len() as u32;
                    fans.vertices.push(vertex);
                }
                fans.of_triangles[t][i] = *number;
            }
        }
        fans
    }
}

/// Whether two triangles with the same direction along an edge coincide.
fn some_are_double(surface: &Mesh, uses: &[Edge], gap: f64) -> bool {
    let is_double = |a: &Edge, b: &Edge| {
        a.forward == b.forward && are_coincident(surface, a.triangle, b.triangle, gap)
    };
    let mut pairs = (0..uses.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
    pairs.any(|(i, j)| is_double(&uses[i], &uses[j]))
}

/// Pairs of triangles at an edge that bound the same body: of opposite direction along it, with the
/// smallest angle through the solid.
fn neighbours<'e>(surface: &Mesh, uses: &'e [Edge], gap: f64) -> Vec<(&'e Edge, &'e Edge)> {
    let (low, high) = uses[0].between;
    let [from, to] = [low, high].map(|v| surface.vertices()[v as usize]);
    let along = (to - from).normalize_or_zero();
    let across = |edge: &Edge| {
        let corners = surface.triangles()[edge.triangle as usize];
        let opposite = corners.into_iter().find(|&v| v != low && v != high);
        let to_opposite = opposite.map_or(DVec3::ZERO, |v| surface.vertices()[v as usize] - from);
        to_opposite - along * to_opposite.dot(along)
    };
    let angle = |forward: &Edge, backward: &Edge| {
        if are_coincident(surface, forward.triangle, backward.triangle, gap) {
            return TAU;
        }
        let (u, v) = (across(forward), across(backward));
        let angle = v.dot(u.cross(along)).atan2(v.dot(u));
        if angle < 0.0 { angle + TAU } else { angle }
    };
    let of_sense = |forward: bool| {
        uses.iter()
            .enumerate()
            .filter(move |e| e.1.forward == forward)
    };
    let mut pairs: Vec<_> = of_sense(true)
        .flat_map(|(i, f)| of_sense(false).map(move |(j, b)| (i, j, f, b)))
        .map(|(i, j, f, b)| (angle(f, b), i, j))
        .collect();
    pairs.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    let mut is_taken = vec![false; uses.len()];
    let mut found = Vec::new();
    for (_, i, j) in pairs {
        if !is_taken[i] && !is_taken[j] {
            (is_taken[i], is_taken[j]) = (true, true);
            found.push((&uses[i], &uses[j]));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two boxes that share a face, cut along different diagonals on its two sides. Each keeps its
    /// eight corners.
    #[test]
    fn boxes_that_share_a_face_keep_their_corners() {
        let box_ = Mesh::cuboid([1.0; 3]).unwrap();
        let turn = glamx::DQuat::from_euler(glamx::EulerRot::XYZ, 0.3, 0.7, 1.1);
        let second = box_.vertices().iter().map(|&v| v + DVec3::X);
        let vertices = box_.vertices().iter().copied().chain(second);
        let vertices: Vec<_> = vertices.map(|v| turn * v).collect();
        let second = box_.triangles().iter().map(|t| t.map(|v| v + 8));
        let triangles: Vec<_> = box_.triangles().iter().copied().chain(second).collect();
        let both = Mesh::new(&vertices, &triangles).unwrap();
        // Whatever rounding welds, the fans are those of two boxes.
        let fans = Fans::of(&both, 1e-4);
        assert_eq!(
            fans.vertices.len(),
            16,
            "{} vertices",
            both.vertices().len()
        );
        let of_first: Vec<u32> = fans.of_triangles[..12].iter().flatten().copied().collect();
        assert!(
            fans.of_triangles[12..]
                .iter()
                .flatten()
                .all(|f| !of_first.contains(f))
        );
    }
}
