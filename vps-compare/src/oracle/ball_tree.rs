//! The triangles of a mesh in a tree of balls, which are invariant under rotation.

use glamx::DVec3;
use vps_build::Mesh;

/// A binary tree of balls around triangles; the root is the first node.
pub(super) struct BallTree {
    pub(super) nodes: Vec<Ball>,
}

/// A ball around some triangles.
pub(super) struct Ball {
    pub(super) center: DVec3,
    pub(super) radius: f64,
    pub(super) contents: Contents,
}

/// A triangle, or two child nodes.
#[derive(Clone, Copy)]
pub(super) enum Contents {
    Triangle(usize),
    Balls([usize; 2]),
}

impl BallTree {
    pub(super) fn new(mesh: &Mesh) -> Self {
        let mut triangles: Vec<usize> = (0..mesh.triangles().len()).collect();
        let mut tree = Self {
            nodes: Vec::with_capacity(2 * triangles.len()),
        };
        tree.add(mesh, &mut triangles);
        tree
    }

    /// Adds a ball around triangles, which are bisected across their longest direction.
    fn add(&mut self, mesh: &Mesh, triangles: &mut [usize]) -> usize {
        let corners = |&t: &usize| mesh.corners(t);
        let start = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let (low, high) = triangles
            .iter()
            .flat_map(corners)
            .fold(start, |(l, h), p| (l.min(p), h.max(p)));
        let center = low.midpoint(high);
        let distances = triangles
            .iter()
            .flat_map(corners)
            .map(|p| p.distance(center));
        let this = self.nodes.len();
        self.nodes.push(Ball {
            center,
            radius: distances.fold(0.0, f64::max),
            contents: Contents::Triangle(triangles[0]),
        });
        if triangles.len() > 1 {
            let axis = (high - low).max_position();
            let middle = |t: &usize| corners(t).iter().map(|p| p[axis]).sum::<f64>();
            let half = triangles.len() / 2;
            triangles.select_nth_unstable_by(half, |a, b| {
                middle(a).total_cmp(&middle(b)).then(a.cmp(b))
            });
            let (first, second) = triangles.split_at_mut(half);
            let children = [self.add(mesh, first), self.add(mesh, second)];
            self.nodes[this].contents = Contents::Balls(children);
        }
        this
    }
}
