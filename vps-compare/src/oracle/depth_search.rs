//! The best-first search for the deepest point of a surface in a solid.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use glamx::{DPose3, DVec3};
use vps_build::{ExactSolid, closest_point};

use super::ball_tree::Contents;
use super::indexed_solid::IndexedSolid;

/// Largest number of pieces of each surface that are evaluated for a pose; after that the search is
/// given up. Two surfaces at a constant distance need that many.
const MAX_PIECES: usize = 100_000;

/// A search for the deepest point.
pub(super) struct DepthSearch {
    deepest: f64,
    tolerance: f64,
    pieces_left: usize,
}

/// A region of a surface that may contain a deeper point.
struct Node {
    /// Upper bound of the penetration in the region.
    bound: f64,
    region: Region,
    /// A triangle of the other surface that is likely to be close.
    guess: usize,
}

enum Region {
    Ball(usize),
    /// A part of a triangle, in the frame of the other solid.
    Piece([DVec3; 3]),
}

impl DepthSearch {
    /// A search that ends when no point can be deeper by more than `tolerance` metres.
    pub(super) fn new(tolerance: f64) -> Self {
        Self {
            deepest: 0.0,
            tolerance,
            pieces_left: 0,
        }
    }

    /// The penetration of the deepest point found so far, in metres.
    pub(super) fn deepest(&self) -> f64 {
        self.deepest
    }

    /// Searches a whole surface in the field of a solid, best first, and returns an upper bound of
    /// its penetration.
    pub(super) fn deepest_point(
        &mut self,
        surface: &IndexedSolid,
        field: &ExactSolid,
        to_field: &DPose3,
    ) -> f64 {
        self.pieces_left = MAX_PIECES;
        let mut open = BinaryHeap::from([self.ball(surface, field, to_field, 0, None)]);
        while let Some(Node {
            bound,
            region,
            guess,
        }) = open.pop()
        {
            if bound <= self.deepest + self.tolerance || self.pieces_left == 0 {
                return bound;
            }
            match region {
                Region::Ball(node) => match surface.tree.nodes[node].contents {
                    Contents::Balls(children) => {
                        for child in children {
                            let above = Some((bound, guess));
                            open.push(self.ball(surface, field, to_field, child, above));
                        }
                    }
                    Contents::Triangle(triangle) => {
                        let corners = surface.solid.surface().corners(triangle);
                        let corners = corners.map(|p| *to_field * p);
                        for corner in corners {
                            let depth = field.penetration(corner, guess).penetration_m;
                            self.deepest = self.deepest.max(depth);
                        }
                        open.push(self.piece(field, corners, bound, guess));
                    }
                },
                Region::Piece(corners) => {
                    for half in bisect(corners) {
                        open.push(self.piece(field, half, bound, guess));
                    }
                }
            }
        }
        self.deepest
    }

    /// Evaluates the centre of a ball; `above` has bound and guess of its parent, if it has one.
    fn ball(
        &mut self,
        surface: &IndexedSolid,
        field: &ExactSolid,
        to_field: &DPose3,
        node: usize,
        above: Option<(f64, usize)>,
    ) -> Node {
        self.pieces_left = self.pieces_left.saturating_sub(1);
        let ball = &surface.tree.nodes[node];
        let (bound, guess) = above.unwrap_or((f64::INFINITY, 0));
        let at = field.penetration(*to_field * ball.center, guess);
        Node {
            bound: bound.min(at.penetration_m + ball.radius),
            region: Region::Ball(node),
            guess: at.triangle,
        }
    }

    /// Evaluates the centre of a piece.
    fn piece(&mut self, field: &ExactSolid, corners: [DVec3; 3], bound: f64, guess: usize) -> Node {
        self.pieces_left = self.pieces_left.saturating_sub(1);
        let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
        let at = field.penetration(middle, guess);
        self.deepest = self.deepest.max(at.penetration_m);
        let furthest =
            |from: &dyn Fn(DVec3) -> f64| corners.map(from).into_iter().fold(0.0, f64::max);
        // The penetration is Lipschitz continuous with constant one.
        let by_distance = at.penetration_m + furthest(&|p| p.distance(middle));
        // The surface is no further than its triangle closest to the centre; the distance from a
        // triangle is convex and so largest at a corner.
        let closest = field.surface().corners(at.triangle);
        let by_triangle = furthest(&|p| closest_point(closest, p).distance(p));
        Node {
            bound: bound.min(by_distance).min(by_triangle),
            region: Region::Piece(corners),
            guess: at.triangle,
        }
    }
}

/// A triangle bisected across its longest edge.
fn bisect([a, b, c]: [DVec3; 3]) -> [[DVec3; 3]; 2] {
    let turns = [[a, b, c], [b, c, a], [c, a, b]];
    let length = |t: &[DVec3; 3]| t[0].distance_squared(t[1]);
    let longest = turns
        .into_iter()
        .max_by(|s, t| length(s).total_cmp(&length(t)));
    let [a, b, c] = longest.unwrap_or([a, b, c]);
    let middle = a.midpoint(b);
    [[a, middle, c], [middle, b, c]]
}

impl PartialEq for Node {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Node {}

impl PartialOrd for Node {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Node {
    fn cmp(&self, other: &Self) -> Ordering {
        self.bound.total_cmp(&other.bound)
    }
}
