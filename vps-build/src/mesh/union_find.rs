//! Connected components by union-find.

/// Disjoint sets of vertices.
pub(crate) struct UnionFind(Vec<u32>);

impl UnionFind {
    pub(crate) fn new(count: usize) -> Self {
        Self((0..count as u32).collect())
    }

    pub(crate) fn root(&mut self, mut v: u32) -> u32 {
        while self.0[v as usize] != v {
            let above = self.0[self.0[v as usize] as usize];
            self.0[v as usize] = above;
            v = above;
        }
        v
    }

    pub(crate) fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b) as usize] = a.min(b);
    }

    /// The number of sets that hold these vertices.
    pub(crate) fn count(&mut self, vertices: impl Iterator<Item = u32>) -> usize {
        let mut roots: Vec<_> = vertices.map(|v| self.root(v)).collect();
        roots.sort_unstable();
        roots.dedup();
        roots.len()
    }
}
