//! Which facets meet at edges and vertices, found from the positions of their vertices.

use std::collections::BTreeMap;

use rapier3d::math::Vector;

use super::facet::{Facet, Junction};
use crate::precision::core_vector;

/// Equal for vertices at the same position.
pub(crate) type VertexKey = [u32; 3];

/// The key of a vertex at a position.
pub(crate) fn vertex_key(vertex: Vector) -> VertexKey {
    // Zero has two signs.
    core_vector(vertex).to_array().map(|c| (c + 0.0).to_bits())
}

/// An edge by the keys of its two ends, the lesser first.
type EdgeKey = (VertexKey, VertexKey);

fn edge_key(vertices: &[VertexKey; 3], edge: usize) -> EdgeKey {
    let (from, to) = (vertices[edge], vertices[(edge + 1) % 3]);
    (from.min(to), from.max(to))
}

/// Sets the junctions of facets from the keys of their vertices. `degenerate` holds the triangles
/// without an area, in any order: they are not facets, and facets at their edges meet.
pub(crate) fn connect(
    facets: &mut [Facet],
    vertices: &[[VertexKey; 3]],
    degenerate: &[[VertexKey; 3]],
) {
    let joined = joined_edges(degenerate);
    let canonical = |key: EdgeKey| joined.get(&key).copied().unwrap_or(key);
    let corners = (0..facets.len()).flat_map(|f| [0, 1, 2].map(|c| (vertices[f][c], f, c)));
    let mut corners: Vec<_> = corners.collect();
    corners.sort_unstable();
    let edges = (0..facets.len()).flat_map(|f| {
        [0, 1, 2].map(|e| {
            let key = edge_key(&vertices[f], e);
            (canonical(key), f, e, key)
        })
    });
    let mut edges: Vec<_> = edges.collect();
    edges.sort_unstable();
    for group in edges.chunk_by(|a, b| a.0 == b.0) {
        let normals = group.iter().map(|&(_, f, ..)| (facets[f].normal, 1.0));
        let mut junction = Junction::of_normals(normals);
        junction.is_border = group.len() == 1;
        let widths = group.iter().map(|&(_, f, ..)| facets[f].width());
        junction.width = widths.fold(f32::INFINITY, f32::min);
        junction.is_concave = group.iter().any(|&(_, f, e, _)| {
            let facet = &facets[f];
            group.iter().any(|&(_, other, other_edge, _)| {
                let opposite = facets[other].corners[(other_edge + 2) % 3];
                // Rounding alone decides on which side a facet's own corners lie.
                other != f && (opposite - facet.corners[e]).dot(facet.normal) > 0.0
            })
        });
        for (i, &(_, f, e, key)) in group.iter().enumerate() {
            facets[f].edges[e] = junction;
            facets[f].is_shared[e] = group[..i].iter().any(|earlier| earlier.3 == key);
        }
    }
    for group in corners.chunk_by(|a, b| a.0 == b.0) {
        let weighted = group
            .iter()
            .map(|&(_, f, c)| (facets[f].normal, facets[f].angle(c)));
        let mut junction = Junction::of_normals(weighted);
        let edges = || {
            group
                .iter()
                .flat_map(|&(_, f, c)| [facets[f].edges[c], facets[f].edges[(c + 2) % 3]])
        };
        junction.is_border = edges().any(|e| e.is_border);
        junction.is_concave = edges().any(|e| e.is_concave);
        for &(_, f, c) in group {
            facets[f].vertices[c] = junction;
        }
    }
}

/// The representative of each edge of a degenerate triangle: edges that such triangles join have the
/// same one.
fn joined_edges(degenerate: &[[VertexKey; 3]]) -> BTreeMap<EdgeKey, EdgeKey> {
    let mut joined: BTreeMap<EdgeKey, EdgeKey> = BTreeMap::new();
    for vertices in degenerate {
        let edges = [0, 1, 2].map(|e| edge_key(vertices, e));
        let edges = edges.map(|e| joined.get(&e).copied().unwrap_or(e));
        let first = edges[0].min(edges[1]).min(edges[2]);
        for known in joined.values_mut().filter(|known| edges.contains(known)) {
            *known = first;
        }
        joined.extend(edges.map(|e| (e, first)));
    }
    joined
}
