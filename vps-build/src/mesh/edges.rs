//! Edges of a mesh, and the triangles that meet there.

use rayon::prelude::*;

/// The directed edges of all triangles, sorted by their vertices. Edges between equal vertices are
/// left out.
pub(crate) struct Edges(Vec<Edge>);

#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Edge {
    /// The lower vertex index, then the higher.
    pub(crate) between: (u32, u32),
    pub(crate) triangle: u32,
    pub(crate) forward: bool,
}

impl Edges {
    pub(crate) fn of(triangles: &[[u32; 3]]) -> Self {
        let edges = |(t, &[a, b, c]): (usize, &[u32; 3])| {
            let edges = [(a, b), (b, c), (c, a)];
            let edges = edges.into_iter().filter(|(from, to)| from != to);
            edges.map(move |(from, to)| Edge {
                between: (from.min(to), from.max(to)),
                triangle: t as u32,
                forward: from < to,
            })
        };
        let mut all: Vec<_> = triangles
            .par_iter()
            .enumerate()
            .flat_map_iter(edges)
            .collect();
        all.par_sort_unstable();
        Self(all)
    }

    /// The uses of each edge, edge by edge.
    pub(crate) fn groups(&self) -> impl Iterator<Item = &[Edge]> {
        self.0.chunk_by(|a, b| a.between == b.between)
    }

    /// The number of edges used more often in one direction than in the other.
    pub(crate) fn open_count(&self) -> usize {
        self.groups().filter(|uses| Self::excess(uses) != 0).count()
    }

    /// Forward uses of an edge less backward uses.
    pub(crate) fn excess(uses: &[Edge]) -> i32 {
        uses.iter().map(|e| if e.forward { 1 } else { -1 }).sum()
    }
}
