//! The distance of two surfaces.

use glamx::DPose3;

use super::ball_tree::Contents;
use super::indexed_solid::IndexedSolid;
use super::triangle_distance::squared_distance;

/// The least distance of two triangles, one of each surface; 0 if any meet.
pub(super) fn surface_distance(a: &IndexedSolid, b: &IndexedSolid, b_in_a: &DPose3) -> f64 {
    let mut least = f64::INFINITY;
    let bound = |i: usize, j: usize| {
        let (ball, other) = (&a.tree.nodes[i], &b.tree.nodes[j]);
        let distance = ball.center.distance(*b_in_a * other.center);
        distance - ball.radius - other.radius
    };
    let mut stack = vec![(bound(0, 0), 0, 0)];
    while let Some((at_least, i, j)) = stack.pop() {
        if at_least >= least {
            continue;
        }
        let (ball, other) = (&a.tree.nodes[i], &b.tree.nodes[j]);
        let below = |children: [usize; 2], is_first: bool| {
            let pair = |c| if is_first { (c, j) } else { (i, c) };
            let mut pairs = children.map(pair).map(|(i, j)| (bound(i, j), i, j));
            // The closest pair is visited first.
            pairs.sort_by(|a, b| b.0.total_cmp(&a.0));
            pairs
        };
        match (ball.contents, other.contents) {
            (Contents::Triangle(s), Contents::Triangle(t)) => {
                let second = b.solid.surface().corners(t).map(|p| *b_in_a * p);
                let squared = squared_distance(a.solid.surface().corners(s), second);
                least = least.min(squared.sqrt());
                if least == 0.0 {
                    return 0.0;
                }
            }
            (Contents::Balls(children), Contents::Triangle(_)) => {
                stack.extend(below(children, true));
            }
            (Contents::Triangle(_), Contents::Balls(children)) => {
                stack.extend(below(children, false));
            }
            (Contents::Balls(first), Contents::Balls(second)) => {
                let is_first = ball.radius >= other.radius;
                stack.extend(below(if is_first { first } else { second }, is_first));
            }
        }
    }
    least
}
