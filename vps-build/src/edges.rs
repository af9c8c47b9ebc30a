//! Which triangles meet at an edge.

use rayon::prelude::*;

/// The directed edges of all triangles, those between the same two vertices side by side. What
/// begins and ends at one vertex is no edge.
pub(crate) struct Edges(Vec<Edge>);

#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Edge {
    /// The vertex with the lower number, then the other.
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

    /// The uses of one edge at a time.
    pub(crate) fn groups(&self) -> impl Iterator<Item = &[Edge]> {
        self.0.chunk_by(|a, b| a.between == b.between)
    }

    /// How many edges are used more often one way than the other.
    pub(crate) fn open_count(&self) -> usize {
        self.groups().filter(|uses| Self::excess(uses) != 0).count()
    }

    /// How often an edge is used forwards more than backwards.
    pub(crate) fn excess(uses: &[Edge]) -> i32 {
        uses.iter().map(|e| if e.forward { 1 } else { -1 }).sum()
    }
}
