//! When two moving shapes meet.

use rapier3d::math::{Pose, Real, Vector};
use rapier3d::parry::query::details::ShapeCastOptions;
use rapier3d::parry::query::{NonlinearRigidMotion, ShapeCastHit, ShapeCastStatus};
use vps_core::{Pose3, Vec3};

use crate::contact::PairContact;
use crate::pair::Pair;
use crate::real::{core_pose, core_real, core_vector, real, vector};

/// Advances of a shape cast before it gives up.
const CAST_STEPS: usize = 512;

/// Halvings of the time between an advance too far and the one before.
const HALVINGS: usize = 24;

/// What approaches at less than this share of the speed passes by.
const GRAZING: f32 = 1e-3;

/// How a rigid body moves at a moment.
pub(crate) struct Twist {
    /// The velocity at the origin, in metres a second.
    linear: Vec3,
    /// In radians a second.
    angular: Vec3,
}

impl Twist {
    fn at(&self, point: Vec3) -> Vec3 {
        self.linear + self.angular.cross(point)
    }
}

/// How two shapes move.
pub(crate) trait Motion {
    /// The pose of the second shape in the frame of the first.
    fn pose12(&self, time: Real) -> Pose;

    /// How the second shape moves relative to the first, in the frame of the first.
    fn twist12(&self, time: Real) -> Twist;

    /// No two points of the shapes come closer to each other faster than this.
    fn closing_speed(&self) -> Real;
}

/// The second shape moves without turning.
pub(crate) struct Linear {
    pub(crate) start: Pose,
    pub(crate) velocity: Vector,
}

impl Motion for Linear {
    fn pose12(&self, time: Real) -> Pose {
        self.start.append_translation(self.velocity * time)
    }

    fn twist12(&self, _time: Real) -> Twist {
        Twist {
            linear: core_vector(self.velocity),
            angular: Vec3::ZERO,
        }
    }

    fn closing_speed(&self) -> Real {
        self.velocity.length()
    }
}

/// Both shapes move and turn in a world.
pub(crate) struct Turning<'m> {
    pub(crate) motions: [&'m NonlinearRigidMotion; 2],
    pub(crate) closing_speed: Real,
}

impl Motion for Turning<'_> {
    fn pose12(&self, time: Real) -> Pose {
        let [pos1, pos2] = self.motions.map(|m| m.position_at_time(time));
        pos1.inv_mul(&pos2)
    }

    fn twist12(&self, time: Real) -> Twist {
        let pos1 = self.motions[0].position_at_time(time);
        let [velocity1, velocity2] = self.motions.map(|m| {
            let center = m.position_at_time(time) * m.local_center;
            m.linvel + m.angvel.cross(pos1.translation - center)
        });
        let spin = self.motions[1].angvel - self.motions[0].angvel;
        let to_first = pos1.rotation.inverse();
        Twist {
            linear: core_vector(to_first * (velocity2 - velocity1)),
            angular: core_vector(to_first * spin),
        }
    }

    fn closing_speed(&self) -> Real {
        self.closing_speed
    }
}

/// Conservative advancement: as long as the shapes are apart, neither can meet the other sooner
/// than their distance divided by their closing speed. From afar what a distance may be off is taken
/// from it; close by, where that is more than the distance, half of it. Shapes that cannot meet in
/// time are not looked at closer than that.
///
/// A shape that is close to another, as a body that slides on its ground is, has no way to go by that
/// measure: it goes half a voxel, or a quarter of the thickness of the thinner of the two, at a time,
/// and back to when it met something if it did. On level ground it goes as far as that is known to
/// be.
///
/// Unless it stops at penetration, what is within the target distance already is only met if it comes
/// closer.
pub(crate) fn cast(
    pair: &Pair<'_>,
    motion: &impl Motion,
    start_time: Real,
    options: ShapeCastOptions,
) -> Option<ShapeCastHit> {
    let cast = Cast {
        pair,
        motion,
        target: options.target_distance,
        tolerance: real(1e-4 * pair.size()),
        meets_all: options.stop_at_penetration,
    };
    cast.run(start_time, options.max_time_of_impact)
}

struct Cast<'c, 's, M> {
    pair: &'c Pair<'s>,
    motion: &'c M,
    target: Real,
    tolerance: Real,
    /// Also what does not come closer.
    meets_all: bool,
}

impl<M: Motion> Cast<'_, '_, M> {
    fn run(&self, start_time: Real, end_time: Real) -> Option<ShapeCastHit> {
        let (near, error) = (real(4.0 * self.pair.resolution()), real(self.pair.error()));
        let thickness = real(self.pair.thickness());
        let stride = ((0.125 * near).max(0.25 * thickness))
            .max(0.5 * self.target)
            .max(self.tolerance);
        let speed = self.motion.closing_speed();
        let (mut time, mut before) = (start_time, start_time);
        for _ in 0..CAST_STEPS {
            let way = speed * (end_time - time).max(0.0);
            // What is further away is not met; the deepest is, should there be anything.
            let closest = self.closest(time, way + error)?;
            let free = self.free(&closest);
            if free <= self.tolerance
                && let Some(contact) = self.met_by(time, closest)
            {
                let (time, contact) = self.first_met([before, time], contact);
                let is_start = time == start_time && self.free(&contact) <= 0.0;
                let status = if is_start {
                    ShapeCastStatus::PenetratingOrWithinTargetDist
                } else {
                    ShapeCastStatus::Converged
                };
                return Some(hit(time, &contact, status));
            }
            before = time;
            if free > stride {
                time += (free - error).max(0.5 * free.min(near)) / speed;
            } else if time < end_time {
                let level = real(self.pair.level_reach(&self.pose12(time)));
                time = (time + stride.max(level) / speed).min(end_time);
            } else {
                return None;
            }
            // Also when nothing moves.
            let in_time = time <= end_time;
            if !in_time {
                return None;
            }
        }
        let closest = self.closest(time, Real::INFINITY)?;
        Some(hit(time, &closest, ShapeCastStatus::OutOfIterations))
    }

    fn pose12(&self, time: Real) -> Pose3 {
        core_pose(&self.motion.pose12(time))
    }

    /// The deepest contact up to a way beyond the target distance.
    fn closest(&self, time: Real, way: Real) -> Option<PairContact> {
        let within = core_real(self.target + way + self.tolerance);
        self.pair.deepest(&self.pose12(time), within)
    }

    /// The deepest contact by which the shapes meet at a time, if they do. Round what is deepest there
    /// are others much like it, which tell nothing that it does not; elsewhere may be a wall, which
    /// field and shell agree about.
    fn met(&self, time: Real) -> Option<PairContact> {
        self.met_by(time, self.closest(time, 0.0)?)
    }

    /// The same where the deepest contact is known.
    fn met_by(&self, time: Real, deepest: PairContact) -> Option<PairContact> {
        let twist = self.motion.twist12(time);
        let slowest = -GRAZING * core_real(self.motion.closing_speed());
        // Whether the shapes come closer to each other at a point, along a normal out of the first.
        let closes = |point: Vec3, normal: Vec3| twist.at(point).dot(normal) < slowest;
        if self.meets_all || closes(deepest.points[0], deepest.normals[0]) {
            return Some(deepest);
        }
        let is_met = |contact: &PairContact| closes(contact.points[0], contact.normals[0]);
        let beside = deepest.normals[0];
        let within = core_real(self.target + self.tolerance);
        self.pair
            .deepest_of(&self.pose12(time), within, beside, &closes, &is_met)
    }

    fn free(&self, contact: &PairContact) -> Real {
        real(-contact.penetration) - self.target
    }

    /// The time something was met first, between one when nothing was and one when `contact` was.
    fn first_met(
        &self,
        [mut before, mut time]: [Real; 2],
        mut contact: PairContact,
    ) -> (Real, PairContact) {
        for _ in 0..HALVINGS {
            let is_close = self.free(&contact) >= -self.tolerance;
            let way = self.motion.closing_speed() * (time - before);
            if is_close || way <= self.tolerance {
                break;
            }
            let middle = before + 0.5 * (time - before);
            match self.met(middle) {
                Some(earlier) => (time, contact) = (middle, earlier),
                None => before = middle,
            }
        }
        (time, contact)
    }
}

fn hit(time: Real, contact: &PairContact, status: ShapeCastStatus) -> ShapeCastHit {
    let [witness1, witness2] = contact.points.map(vector);
    let [normal1, normal2] = contact.normals.map(|n| vector(without_noise(n)));
    ShapeCastHit {
        time_of_impact: time,
        witness1,
        witness2,
        normal1,
        normal2,
        status,
        subshape1: 0,
        subshape2: 0,
    }
}

/// A normal along an axis but for rounding: rapier's character controller takes even that for a slope
/// to slip down, and stops.
fn without_noise(normal: Vec3) -> Vec3 {
    let is_noise = normal.abs().cmplt(Vec3::splat(NOISE));
    Vec3::select(is_noise, Vec3::ZERO, normal).normalize()
}

/// What components of normals may be off by rounding.
const NOISE: f32 = 1e-5;
