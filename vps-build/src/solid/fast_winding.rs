//! Generalised winding numbers (Jacobson, Kavan and Sorkine-Hornung, 2013): the solid angle of all
//! triangles seen from a point, over 4π. It is near 1 inside and near 0 outside of a mesh with
//! small cracks.
//!
//! Distant groups of triangles count as one dipole (Barill et al., 2018).

use std::borrow::Cow;
use std::f64::consts::PI;

use glamx::DVec3;

use crate::mesh::Mesh;

/// Distance, in radii, beyond which a group counts as a dipole.
const FAR_RADII: f64 = 3.0;

/// Maximum triangles of a leaf.
const LEAF_SIZE: usize = 8;

pub(crate) struct FastWinding<'m> {
    mesh: Cow<'m, Mesh>,
    triangles: Vec<u32>,
    nodes: Vec<Node>,
}

struct Node {
    /// Area-weighted centre.
    center: DVec3,
    /// Distance of the furthest corner from it.
    radius: f64,
    /// Sum of the areas times the outward normals.
    dipole: DVec3,
    first: u32,
    count: u32,
    /// Index of the second child, 0 for a leaf. The first child is the next node.
    second_child: u32,
}

impl<'m> FastWinding<'m> {
    pub(crate) fn new(mesh: &'m Mesh) -> Self {
        Self::of(Cow::Borrowed(mesh))
    }

    pub(crate) fn of(mesh: Cow<'m, Mesh>) -> Self {
        let count = mesh.triangles().len();
        let mut angle = Self {
            mesh,
            triangles: (0..count as u32).collect(),
            nodes: Vec::new(),
        };
        angle.add_node(0, count);
        angle
    }

    fn add_node(&mut self, first: usize, count: usize) {
        let mesh = &self.mesh;
        let corners = |t: &u32| mesh.corners(*t as usize);
        let triangles = &mut self.triangles[first..first + count];
        let (mut dipole, mut moment, mut area) = (DVec3::ZERO, DVec3::ZERO, 0.0);
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for [a, b, c] in triangles.iter().map(corners) {
            let normal = (b - a).cross(c - a) * 0.5;
            dipole += normal;
            moment += (a + b + c) / 3.0 * normal.length();
            area += normal.length();
            low = low.min(a).min(b).min(c);
            high = high.max(a).max(b).max(c);
        }
        let center = if area > 0.0 {
            moment / area
        } else {
            low.midpoint(high)
        };
        let distance = |v: DVec3| v.distance(center);
        let radius = triangles
            .iter()
            .flat_map(corners)
            .map(distance)
            .fold(0.0, f64::max);
        let this = self.nodes.len();
        self.nodes.push(Node {
            center,
            radius,
            dipole,
            first: first as u32,
            count: count as u32,
            second_child: 0,
        });
        if count > LEAF_SIZE {
            let axis = (high - low).max_position();
            let middle = |t: &u32| corners(t).iter().map(|v| v[axis]).sum::<f64>();
            triangles.select_nth_unstable_by(count / 2, |a, b| {
                middle(a).total_cmp(&middle(b)).then(a.cmp(b))
            });
            self.add_node(first, count / 2);
            self.nodes[this].second_child = self.nodes.len() as u32;
            self.add_node(first + count / 2, count - count / 2);
        }
    }

    /// The generalised winding number of a point, to within about 0.02.
    pub(crate) fn winding(&self, point: DVec3) -> f64 {
        self.sum_below(0, point) / (4.0 * PI)
    }

    fn sum_below(&self, node: usize, point: DVec3) -> f64 {
        let Node {
            center,
            radius,
            dipole,
            first,
            count,
            second_child,
        } = self.nodes[node];
        let to = center - point;
        let distance = to.length();
        if distance > FAR_RADII * radius {
            return dipole.dot(to) / distance.powi(3);
        }
        if second_child != 0 {
            return self.sum_below(node + 1, point) + self.sum_below(second_child as usize, point);
        }
        let triangles = &self.triangles[first as usize..(first + count) as usize];
        let angle = |&t: &u32| solid_angle(self.mesh.corners(t as usize), point);
        triangles.iter().map(angle).sum()
    }
}

/// The solid angle of a triangle, positive seen from behind (Van Oosterom and Strackee, 1983).
fn solid_angle(corners: [DVec3; 3], point: DVec3) -> f64 {
    let [a, b, c] = corners.map(|v| v - point);
    let (la, lb, lc) = (a.length(), b.length(), c.length());
    let denominator = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
    2.0 * a.dot(b.cross(c)).atan2(denominator)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_the_sum_over_all_triangles_and_one_inside() {
        let ball = Mesh::icosphere(0.5, 4).unwrap();
        let holed = Mesh::new(ball.vertices(), &ball.triangles()[200..]).unwrap();
        let angle = FastWinding::new(&holed);
        let mut worst = 0.0_f64;
        for i in 0..400 {
            let turn = f64::from(i) * 2.4;
            let p = DVec3::new(turn.cos(), (turn * 0.7).sin(), turn.sin()) * (f64::from(i) * 0.002);
            let all = (0..holed.triangles().len()).map(|t| solid_angle(holed.corners(t), p));
            let exact = all.sum::<f64>() / (4.0 * PI);
            worst = worst.max((angle.winding(p) - exact).abs());
        }
        assert!(worst < 0.02, "{worst}");
        let whole = FastWinding::new(&ball);
        assert!((whole.winding(DVec3::ZERO) - 1.0).abs() < 0.02);
        assert!(whole.winding(DVec3::X).abs() < 0.02);
    }
}
