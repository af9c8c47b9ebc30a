//! The first contact of a motion.

use glamx::{Pose3, Quat, Vec3};

use crate::aabb::Aabb;
use crate::field::{Discs, DistanceField};
use crate::query::contact::Contact;
use crate::query::posed::Query;
use crate::shell::PointSphereTree;
use crate::simd::{LANES, Points};

/// A pointshell that moves through a distance field during a step: on a straight line, rotating at a
/// constant rate about the origin of its frame. Finds contacts that a query at the end of the step
/// would miss because the body tunnelled through.
///
/// ```
/// use vps_core::{HalfSpace, PointSphereTree, Pose3, Sweep, Vec3};
///
/// let tree = PointSphereTree::flat(&[Vec3::ZERO], &[Vec3::Y], 1e-4)?;
/// let ground = HalfSpace::new(Vec3::Y);
/// let [start, end] = [0.3, -0.1].map(|y| Pose3::from_translation(Vec3::Y * y));
/// let sweep = Sweep::new(&tree, &ground, start, end);
/// let impact = sweep.first_contact(1e-3).unwrap();
/// assert!(impact.time <= 0.75 && impact.time > 0.74);
/// # Ok::<(), vps_core::TreeError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Sweep<'q, F: ?Sized> {
    tree: &'q PointSphereTree<'q>,
    field: &'q F,
    start: Pose3,
    /// From start to end.
    translation: Vec3,
    axis: Vec3,
    angle: f32,
}

/// The first contact of a [`Sweep`].
///
/// ```
/// use vps_core::{HalfSpace, PointSphereTree, Pose3, Sweep, Vec3};
///
/// let tree = PointSphereTree::flat(&[Vec3::ZERO], &[Vec3::Y], 1e-4)?;
/// let ground = HalfSpace::new(Vec3::Y);
/// let [start, end] = [0.3, -0.1].map(|y| Pose3::from_translation(Vec3::Y * y));
/// let sweep = Sweep::new(&tree, &ground, start, end);
/// let impact = sweep.first_contact(1e-3).unwrap();
/// assert!(impact.time <= 0.75 && impact.time > 0.74);
/// assert!(impact.closest.penetration.abs() < 2e-3);
/// assert!(impact.shell_to_field.translation.y < 2e-3);
/// # Ok::<(), vps_core::TreeError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impact {
    /// Time of impact from 0 at the start to 1 at the end, never later than the exact one.
    pub time: f32,
    /// The pose at that time, from shell to field coordinates.
    pub shell_to_field: Pose3,
    /// The closest point of the shell at that time; its penetration is negative if there is still a
    /// gap.
    pub closest: Contact,
}

/// The largest number of times a step is halved.
const MAX_HALVINGS: u32 = 22;

impl<'q, F: DistanceField + ?Sized> Sweep<'q, F> {
    /// A motion from one pose to another; both transform shell coordinates to field coordinates. Of
    /// the two rotations between them the one with the smaller angle is taken.
    pub fn new(tree: &'q PointSphereTree<'q>, field: &'q F, start: Pose3, end: Pose3) -> Self {
        let rotation = end.rotation * start.rotation.inverse();
        // Of the two quaternions of a rotation the one with the smaller angle.
        let rotation = if rotation.w < 0.0 {
            -rotation
        } else {
            rotation
        };
        let (axis, angle) = rotation.normalize().to_axis_angle();
        Self {
            tree,
            field,
            start,
            translation: end.translation - start.translation,
            axis,
            angle,
        }
    }

    /// The pose at a time from 0 to 1.
    pub fn pose_at(&self, time: f32) -> Pose3 {
        let rotation = Quat::from_axis_angle(self.axis, self.angle * time);
        Pose3::from_parts(
            self.start.translation + self.translation * time,
            rotation * self.start.rotation,
        )
    }

    /// The first time at which a point of the shell may be in the solid, known to within
    /// `tolerance` metres of motion; `None` if none is during the whole motion, or the motion is
    /// not finite.
    ///
    /// Bisection: an interval is discarded if nothing touches at its middle with all balls and
    /// points inflated by their motion up to its ends. Costs about two touch tests a bisection, up
    /// to the first contact. A tolerance below a four-millionth of the motion is not reached.
    pub fn first_contact(&self, tolerance: f32) -> Option<Impact> {
        // Upper bound on the speed of any point, in metres a step.
        let speed =
            self.translation.length() + self.angle.abs() * self.tree.origin_distance_bound();
        if !(speed.is_finite() && self.start.is_finite()) {
            return None;
        }
        let (mut depth, mut index) = (0, 0_u32);
        loop {
            let length = 1.0 / (1_u32 << depth) as f32;
            let start = index as f32 * length;
            let field = Inflated {
                field: self.field,
                by: 0.5 * length * speed,
            };
            let middle = self.pose_at(start + 0.5 * length);
            if Query::new(self.tree, &field, middle).touches() {
                if length * speed <= tolerance || depth == MAX_HALVINGS {
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
            // The next interval, as long as possible.
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

/// A field whose solid is inflated by a distance in metres.
struct Inflated<'f, F: ?Sized> {
    field: &'f F,
    by: f32,
}

impl<F: DistanceField + ?Sized> DistanceField for Inflated<'_, F> {
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
