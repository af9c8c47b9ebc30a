//! The first contact of a motion.

use glamx::{Pose3, Quat, Vec3};

use crate::aabb::Aabb;
use crate::field::{Discs, DistanceField};
use crate::query::contact::Contact;
use crate::query::posed::Query;
use crate::shell::PointSphereTree;
use crate::simd::{LANES, Points};

/// A pointshell that moves through a distance field during a step: on a straight line, turning at
/// a constant rate about the origin of its frame. Finds what a query at the end of the step would
/// miss because the body went through.
#[derive(Clone, Copy, Debug)]
pub struct Sweep<'q, F: ?Sized> {
    tree: &'q PointSphereTree<'q>,
    field: &'q F,
    start: Pose3,
    /// From start to end.
    way: Vec3,
    axis: Vec3,
    angle: f32,
}

/// The first contact of a [`Sweep`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impact {
    /// When, from 0 at the start to 1 at the end. Never later than the true time.
    pub time: f32,
    /// The pose then, from shell to field coordinates.
    pub shell_to_field: Pose3,
    /// The point of the shell that is closest then; its penetration is negative as long as there
    /// is a gap.
    pub closest: Contact,
}

/// How often a step is halved at most.
const MOST_HALVINGS: u32 = 22;

impl<'q, F: DistanceField + ?Sized> Sweep<'q, F> {
    /// A motion from one pose to another; both take shell coordinates to field coordinates. The
    /// body turns the shorter way round.
    pub fn new(tree: &'q PointSphereTree<'q>, field: &'q F, start: Pose3, end: Pose3) -> Self {
        let turn = end.rotation * start.rotation.inverse();
        // Of the two quaternions of a rotation the one with the smaller angle.
        let turn = if turn.w < 0.0 { -turn } else { turn };
        let (axis, angle) = turn.normalize().to_axis_angle();
        Self {
            tree,
            field,
            start,
            way: end.translation - start.translation,
            axis,
            angle,
        }
    }

    /// The pose at a time from 0 to 1.
    pub fn pose_at(&self, time: f32) -> Pose3 {
        let turn = Quat::from_axis_angle(self.axis, self.angle * time);
        Pose3::from_parts(
            self.start.translation + self.way * time,
            turn * self.start.rotation,
        )
    }

    /// The first time at which a point of the shell may be in the solid, known to within
    /// `tolerance` metres of motion; `None` if none is during the whole motion, or the motion is
    /// not finite.
    ///
    /// Halves the step and leaves out the halves during which, at their middle and with all balls
    /// and points grown by how far they move until its ends, nothing touches. Costs about two
    /// tests for touch for each halving, all the way up to the first contact. A tolerance below a
    /// four-millionth of the way is not reached.
    pub fn first_contact(&self, tolerance: f32) -> Option<Impact> {
        // No point is faster, in metres a step.
        let speed = self.way.length() + self.angle.abs() * self.tree.reach();
        if !(speed.is_finite() && self.start.is_finite()) {
            return None;
        }
        let (mut depth, mut index) = (0, 0_u32);
        loop {
            let length = 1.0 / (1_u32 << depth) as f32;
            let start = index as f32 * length;
            let field = Grown {
                field: self.field,
                by: 0.5 * length * speed,
            };
            let middle = self.pose_at(start + 0.5 * length);
            if Query::new(self.tree, &field, middle).touches() {
                if length * speed <= tolerance || depth == MOST_HALVINGS {
                    let pose = self.pose_at(start);
                    return Query::new(self.tree, self.field, pose)
                        .closest()
                        .map(|closest| Impact {
                            time: start,
                            shell_to_field: pose,
                            closest,
                        });
                }
                depth += 1;
                index *= 2;
                continue;
            }
            // On to the next part, as long as it can be.
            index += 1;
            while index.is_multiple_of(2) && depth > 0 {
                index /= 2;
                depth -= 1;
            }
            if depth == 0 {
                return None;
            }
        }
    }
}

/// A field whose solid is larger by a distance in metres.
struct Grown<'f, F: ?Sized> {
    field: &'f F,
    by: f32,
}

impl<F: DistanceField + ?Sized> DistanceField for Grown<'_, F> {
    fn penetration(&self, point: Vec3, _normal: Vec3) -> f32 {
        self.field.penetration_bound(point, self.by)
    }

    fn inward_direction(&self, point: Vec3) -> Vec3 {
        self.field.inward_direction(point)
    }

    fn penetration_bound(&self, center: Vec3, radius: f32) -> f32 {
        self.field.penetration_bound(center, radius + self.by)
    }

    fn bounds(&self) -> Aabb {
        let bounds = self.field.bounds();
        Aabb {
            min: bounds.min - self.by,
            max: bounds.max + self.by,
        }
    }

    fn error_bound(&self) -> f32 {
        self.field.error_bound()
    }

    #[inline(always)]
    fn penetrations(&self, points: &Points, _normals: &Points) -> [f32; LANES] {
        let balls = Discs::balls(points, [self.by; LANES]);
        self.field.penetration_bounds(&balls)
    }

    #[inline(always)]
    fn penetration_bounds(&self, discs: &Discs) -> [f32; LANES] {
        self.field.penetration_bounds(&discs.grown(self.by))
    }
}
