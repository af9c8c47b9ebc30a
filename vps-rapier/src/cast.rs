//! When two moving shapes meet.

use rapier3d::math::{Pose, Real};
use rapier3d::parry::query::details::ShapeCastOptions;
use rapier3d::parry::query::{ShapeCastHit, ShapeCastStatus};

use crate::pair::Pair;
use crate::real::{core_pose, real, vector};

/// Advances of a shape cast before it gives up.
const CAST_STEPS: usize = 64;

/// Conservative advancement: as long as the shapes are apart, neither can meet the other sooner
/// than their distance divided by their closing speed. From afar the lower bound of the distance
/// is taken, since distances of a voxelmap may be too large there; close by, where that bound is
/// mostly its own error, half of the distance.
pub(crate) fn cast(
    pair: &Pair<'_>,
    pose_at: impl Fn(Real) -> Pose,
    closing_speed: Real,
    start_time: Real,
    options: ShapeCastOptions,
) -> Option<ShapeCastHit> {
    let near = real(4.0 * pair.resolution());
    let tolerance = real(1e-4 * pair.size());
    let closest = |time| pair.deepest(&core_pose(&pose_at(time)), f32::INFINITY);
    let mut time = start_time;
    let mut status = ShapeCastStatus::OutOfIterations;
    let mut closest_now = closest(time)?;
    if real(-closest_now.penetration) <= options.target_distance {
        if !options.stop_at_penetration {
            return None;
        }
        status = ShapeCastStatus::PenetratingOrWithinTargetDist;
    } else {
        for _ in 0..CAST_STEPS {
            let free = real(-closest_now.penetration) - options.target_distance;
            if free <= tolerance {
                status = ShapeCastStatus::Converged;
                break;
            }
            let clearance = real(pair.clearance(&core_pose(&pose_at(time))));
            let sure = clearance - options.target_distance;
            time += sure.max(0.5 * free.min(near)) / closing_speed;
            // Also when nothing moves.
            let in_time = time <= options.max_time_of_impact;
            if !in_time {
                return None;
            }
            closest_now = closest(time)?;
        }
    }
    let [witness1, witness2] = closest_now.points.map(vector);
    let [normal1, normal2] = closest_now.normals.map(vector);
    Some(ShapeCastHit {
        time_of_impact: time,
        witness1,
        witness2,
        normal1,
        normal2,
        status,
        subshape1: 0,
        subshape2: 0,
    })
}
