//! The time at which two moving shapes meet.

use rapier3d::math::Real;
use rapier3d::parry::query::details::ShapeCastOptions;
use rapier3d::parry::query::{ShapeCastHit, ShapeCastStatus};
use vps_core::{Pose3, Vec3};

use super::motion::Motion;
use super::pair::Pair;
use super::pair_contact::PairContact;
use crate::precision::{core_pose, core_real, real, vector};

/// Most advances of a shape cast.
const MAX_ADVANCES: usize = 512;

/// Most bisections of the time between an advance too far and the one before.
const MAX_BISECTIONS: usize = 24;

/// Tolerance of the distance at an impact, relative to the diagonal of the smallest shell.
const DISTANCE_TOLERANCE: f32 = 1e-4;

/// Distance in voxels up to which shapes advance by at least half of their distance, whatever the error
/// of the field.
const NEAR_VOXELS: f32 = 4.0;

/// Advance of shapes that are within a stride of each other, relative to the near distance: half a
/// voxel.
const NEAR_STRIDE: f32 = 0.125;

/// The same relative to the thickness of the thinner shape.
const THICKNESS_STRIDE: f32 = 0.25;

/// Fraction of the closing speed below which contacts pass each other instead of approaching.
const GRAZING: f32 = 1e-3;

/// Components of unit normals below this are rounding.
const NORMAL_NOISE: f32 = 1e-5;

/// Conservative advancement: shapes that are apart cannot meet sooner than their distance divided by
/// their closing speed. From afar the error of the field is subtracted from the distance; where the
/// error exceeds the distance, half of the distance is used. Shapes that cannot meet within the time
/// are not looked at.
///
/// For a shape close to another, such as a body that slides on its ground, the advance by that measure
/// is zero. It advances by half a voxel, or by a quarter of the thickness of the thinner shape if that
/// is more, and bisects the time back to the impact if it has met something. Along a single plane it
/// advances as far as the plane is known to extend.
///
/// Unless `options.stop_at_penetration` is set, shapes within the target distance only meet if they
/// approach.
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
        tolerance: real(DISTANCE_TOLERANCE * pair.size()),
        stop_at_penetration: options.stop_at_penetration,
    };
    cast.run(start_time, options.max_time_of_impact)
}

struct Cast<'c, 's, M> {
    pair: &'c Pair<'s>,
    motion: &'c M,
    target: Real,
    tolerance: Real,
    /// Whether contacts that do not approach count as well.
    stop_at_penetration: bool,
}

impl<M: Motion> Cast<'_, '_, M> {
    fn run(&self, start_time: Real, end_time: Real) -> Option<ShapeCastHit> {
        let near = real(NEAR_VOXELS * self.pair.resolution());
        let error = real(self.pair.error());
        let thickness = real(self.pair.thickness());
        let stride = ((real(NEAR_STRIDE) * near).max(real(THICKNESS_STRIDE) * thickness))
            .max(0.5 * self.target)
            .max(self.tolerance);
        let speed = self.motion.closing_speed();
        let (mut time, mut previous_time) = (start_time, start_time);
        for _ in 0..MAX_ADVANCES {
            let remaining = speed * (end_time - time).max(0.0);
            // Contacts beyond the remaining distance cannot be reached.
            let closest = self.closest(time, remaining + error)?;
            let clearance = self.clearance(&closest);
            if clearance <= self.tolerance
                && let Some(contact) = self.impact_given(time, closest)
            {
                let (time, contact) = self.first_impact([previous_time, time], contact);
                let is_start = time == start_time && self.clearance(&contact) <= 0.0;
                let status = if is_start {
                    ShapeCastStatus::PenetratingOrWithinTargetDist
                } else {
                    ShapeCastStatus::Converged
                };
                return Some(hit(time, &contact, status));
            }
            previous_time = time;
            if clearance > stride {
                time += (clearance - error).max(0.5 * clearance.min(near)) / speed;
            } else if time < end_time {
                let plane_reach = real(self.pair.plane_reach(&self.pose12(time)));
                time = (time + stride.max(plane_reach) / speed).min(end_time);
            } else {
                return None;
            }
            // False also for the NaN or infinity of a speed of zero.
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

    /// The deepest contact up to a distance beyond the target distance.
    fn closest(&self, time: Real, distance: Real) -> Option<PairContact> {
        let prediction = core_real(self.target + distance + self.tolerance);
        self.pair.deepest(&self.pose12(time), prediction)
    }

    /// The deepest contact by which the shapes meet at a time, if they do.
    fn impact(&self, time: Real) -> Option<PairContact> {
        self.impact_given(time, self.closest(time, 0.0)?)
    }

    /// The same where the deepest contact is known. If that one does not approach, contacts with a
    /// similar normal are of the same surface and do not either; others may belong to a wall.
    fn impact_given(&self, time: Real, deepest: PairContact) -> Option<PairContact> {
        let twist = self.motion.twist12(time);
        let slowest = -GRAZING * core_real(self.motion.closing_speed());
        // Whether the shapes approach at a point, along a normal out of the first shape.
        let approaches = |point: Vec3, normal: Vec3| twist.at(point).dot(normal) < slowest;
        if self.stop_at_penetration || approaches(deepest.points[0], deepest.normals[0]) {
            return Some(deepest);
        }
        let accept = |contact: &PairContact| approaches(contact.points[0], contact.normals[0]);
        let prediction = core_real(self.target + self.tolerance);
        self.pair.deepest_of(
            &self.pose12(time),
            prediction,
            deepest.normals[0],
            &approaches,
            &accept,
        )
    }

    /// Distance beyond the target distance.
    fn clearance(&self, contact: &PairContact) -> Real {
        real(-contact.penetration) - self.target
    }

    /// Bisects for the first impact, between a time without one and a time with `contact`.
    fn first_impact(
        &self,
        [mut before, mut time]: [Real; 2],
        mut contact: PairContact,
    ) -> (Real, PairContact) {
        for _ in 0..MAX_BISECTIONS {
            let is_close = self.clearance(&contact) >= -self.tolerance;
            let distance = self.motion.closing_speed() * (time - before);
            if is_close || distance <= self.tolerance {
                break;
            }
            let middle = before + 0.5 * (time - before);
            match self.impact(middle) {
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

/// A unit normal without components that are rounding. rapier's character controller takes even those
/// for a slope to slide down, and stops.
fn without_noise(normal: Vec3) -> Vec3 {
    let is_noise = normal.abs().cmplt(Vec3::splat(NORMAL_NOISE));
    Vec3::select(is_noise, Vec3::ZERO, normal).normalize()
}
