use std::cmp::Ordering;
use std::collections::BinaryHeap;

use glamx::{DPose3, DVec3};
use rapier3d::math::Pose;
use vps_build::{ExactSolid, closest_point};

use super::balls::{BallTree, Holds};
use super::triangles::squared_distance;

/// The exact penetration of two solids, whatever their shape.
///
/// Apart, it is their distance, negative: of all pairs of triangles the closest, in 64 bits.
/// Overlapping, it is how deep the deepest point of either surface is in the other solid, as its
/// distance from the other surface. All points of all triangles count, not the vertices alone: the
/// triangles are cut up where a point could be deeper than those found, until none can be by more
/// than the tolerance.
///
/// For bodies that overlap a little that is the way out as well. For those deep in each other the
/// shortest way out is longer, for convex solids as for others.
///
/// Nothing is exact of a mesh that [is open](Self::is_open).
pub struct SolidOracle {
    ground: Side,
    body: Side,
    tolerance: f64,
}

/// What an oracle says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exact {
    /// In metres, positive when the solids overlap.
    pub penetration_m: f64,
    /// By how much the true value may be larger, in metres; finite. More than the
    /// [tolerance](SolidOracle::tolerance_m) where the search was given up.
    pub uncertainty_m: f64,
}

/// What part of the size of the smaller solid a depth may be off.
const TOLERANCE: f64 = 1e-5;

/// How many pieces of each surface are looked at for a pose; after that the answer is as uncertain as
/// it says. Two surfaces at the same distance everywhere need that many.
const MOST_PIECES: usize = 100_000;

/// Surfaces this close, as a part of their size, may cross, for all that rounding lets one see.
const ROUNDING: f64 = 1e-12;

struct Side {
    solid: ExactSolid,
    tree: BallTree,
    size: f64,
}

impl Side {
    fn new(solid: ExactSolid) -> Self {
        let (low, high) = solid.surface().bounds();
        Self {
            tree: BallTree::new(solid.surface()),
            size: (high - low).max_element(),
            solid,
        }
    }
}

impl SolidOracle {
    /// An oracle for two solids.
    pub fn new(ground: ExactSolid, body: ExactSolid) -> Self {
        let (ground, body) = (Side::new(ground), Side::new(body));
        Self {
            tolerance: TOLERANCE * ground.size.min(body.size),
            ground,
            body,
        }
    }

    /// How uncertain the penetration is at most where the search came to its end, in metres.
    pub fn tolerance_m(&self) -> f64 {
        self.tolerance
    }

    /// Whether the ground's surface has holes that were left open, and whether the body's has. What
    /// is inside of such a one, and how far from its surface, is a guess.
    pub fn is_open(&self) -> [bool; 2] {
        [&self.ground, &self.body].map(|side| side.solid.repairs().left_open)
    }

    /// The distance of the two solids in metres, 0 if they meet.
    pub fn separation(&self, body_in_ground: &Pose) -> f64 {
        self.distance(&exact(body_in_ground)).unwrap_or(0.0)
    }

    /// The penetration for a pose of the body in the ground's frame.
    pub fn penetration(&self, body_in_ground: &Pose) -> Exact {
        let pose = exact(body_in_ground);
        if let Some(distance) = self.distance(&pose) {
            return Exact {
                penetration_m: -distance,
                uncertainty_m: 0.0,
            };
        }
        let mut search = Search {
            deepest: 0.0,
            tolerance: self.tolerance,
            pieces_left: 0,
        };
        let bounds = [
            search.deepest_point(&self.body, &self.ground.solid, &pose),
            search.deepest_point(&self.ground, &self.body.solid, &pose.inverse()),
        ];
        let bound = bounds[0].max(bounds[1]);
        Exact {
            penetration_m: search.deepest,
            uncertainty_m: (bound - search.deepest).max(0.0),
        }
    }

    /// The distance of the solids, if they do not overlap.
    fn distance(&self, pose: &DPose3) -> Option<f64> {
        let distance = between_surfaces(&self.ground, &self.body, pose);
        let (ground, body) = (&self.ground.solid, &self.body.solid);
        // Without a crossing a part is inside as a whole or not at all.
        let is_apart = distance > ROUNDING * self.ground.size.max(self.body.size)
            && !body.parts().iter().any(|p| ground.contains(*pose * *p))
            && !ground
                .parts()
                .iter()
                .any(|p| body.contains(pose.inverse() * *p));
        is_apart.then_some(distance)
    }
}

/// The pose that 32 bits mean, its rotation being one to 64 bits.
fn exact(pose: &Pose) -> DPose3 {
    let pose = DPose3::from(*pose);
    DPose3::from_parts(pose.translation, pose.rotation.normalize())
}

/// The least distance of two triangles, 0 if any meet.
fn between_surfaces(a: &Side, b: &Side, b_in_a: &DPose3) -> f64 {
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
            // The closest is looked at first.
            pairs.sort_by(|a, b| b.0.total_cmp(&a.0));
            pairs
        };
        match (ball.holds, other.holds) {
            (Holds::Triangle(s), Holds::Triangle(t)) => {
                let second = b.solid.surface().corners(t).map(|p| *b_in_a * p);
                let squared = squared_distance(a.solid.surface().corners(s), second);
                least = least.min(squared.sqrt());
                if least == 0.0 {
                    return 0.0;
                }
            }
            (Holds::Balls(children), Holds::Triangle(_)) => stack.extend(below(children, true)),
            (Holds::Triangle(_), Holds::Balls(children)) => stack.extend(below(children, false)),
            (Holds::Balls(first), Holds::Balls(second)) => {
                let is_first = ball.radius >= other.radius;
                stack.extend(below(if is_first { first } else { second }, is_first));
            }
        }
    }
    least
}

/// A search for the deepest point.
struct Search {
    deepest: f64,
    tolerance: f64,
    pieces_left: usize,
}

/// A part of a surface that may hold a deeper point.
struct Candidate {
    /// No point of it is deeper.
    bound: f64,
    place: Place,
    /// A triangle of the other surface that may be close.
    guess: usize,
}

enum Place {
    Ball(usize),
    /// A part of a triangle, in the frame of the other solid.
    Piece([DVec3; 3]),
}

impl Search {
    /// Looks at a whole surface in the field of a solid, and gives a bound of what it holds. Where
    /// the bound is largest comes first.
    fn deepest_point(&mut self, surface: &Side, field: &ExactSolid, to_field: &DPose3) -> f64 {
        self.pieces_left = MOST_PIECES;
        let mut open = BinaryHeap::from([self.ball(surface, field, to_field, 0, None)]);
        while let Some(Candidate {
            bound,
            place,
            guess,
        }) = open.pop()
        {
            if bound <= self.deepest + self.tolerance || self.pieces_left == 0 {
                return bound;
            }
            match place {
                Place::Ball(node) => match surface.tree.nodes[node].holds {
                    Holds::Balls(children) => {
                        for child in children {
                            let above = Some((bound, guess));
                            open.push(self.ball(surface, field, to_field, child, above));
                        }
                    }
                    Holds::Triangle(triangle) => {
                        let corners = surface.solid.surface().corners(triangle);
                        let corners = corners.map(|p| *to_field * p);
                        for corner in corners {
                            let depth = field.penetration(corner, guess).penetration_m;
                            self.deepest = self.deepest.max(depth);
                        }
                        open.push(self.piece(field, corners, bound, guess));
                    }
                },
                Place::Piece(corners) => {
                    for half in halves(corners) {
                        open.push(self.piece(field, half, bound, guess));
                    }
                }
            }
        }
        self.deepest
    }

    /// Looks at the middle of a ball; bound and guess of the one above it are known, unless it is that
    /// of the whole surface.
    fn ball(
        &mut self,
        surface: &Side,
        field: &ExactSolid,
        to_field: &DPose3,
        node: usize,
        above: Option<(f64, usize)>,
    ) -> Candidate {
        self.pieces_left = self.pieces_left.saturating_sub(1);
        let ball = &surface.tree.nodes[node];
        let (bound, guess) = above.unwrap_or((f64::INFINITY, 0));
        let at = field.penetration(*to_field * ball.center, guess);
        Candidate {
            bound: bound.min(at.penetration_m + ball.radius),
            place: Place::Ball(node),
            guess: at.triangle,
        }
    }

    /// Looks at the middle of a piece.
    fn piece(
        &mut self,
        field: &ExactSolid,
        corners: [DVec3; 3],
        bound: f64,
        guess: usize,
    ) -> Candidate {
        self.pieces_left = self.pieces_left.saturating_sub(1);
        let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
        let at = field.penetration(middle, guess);
        self.deepest = self.deepest.max(at.penetration_m);
        let furthest =
            |from: &dyn Fn(DVec3) -> f64| corners.map(from).into_iter().fold(0.0, f64::max);
        // Nothing changes faster than the way.
        let by_way = at.penetration_m + furthest(&|p| p.distance(middle));
        // The surface is no further than its triangle closest to the middle, and how far that is, a
        // convex function, is largest at a corner.
        let closest = field.surface().corners(at.triangle);
        let by_triangle = furthest(&|p| closest_point(closest, p).distance(p));
        Candidate {
            bound: bound.min(by_way).min(by_triangle),
            place: Place::Piece(corners),
            guess: at.triangle,
        }
    }
}

/// A triangle cut in two across its longest edge.
fn halves([a, b, c]: [DVec3; 3]) -> [[DVec3; 3]; 2] {
    let turns = [[a, b, c], [b, c, a], [c, a, b]];
    let length = |t: &[DVec3; 3]| t[0].distance_squared(t[1]);
    let longest = turns
        .into_iter()
        .max_by(|s, t| length(s).total_cmp(&length(t)));
    let [a, b, c] = longest.unwrap_or([a, b, c]);
    let middle = a.midpoint(b);
    [[a, middle, c], [middle, b, c]]
}

impl PartialEq for Candidate {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Candidate {}

impl PartialOrd for Candidate {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Candidate {
    fn cmp(&self, other: &Self) -> Ordering {
        self.bound.total_cmp(&other.bound)
    }
}
