//! When two moving shapes meet.

use rapier3d::math::{Pose, Real};
use rapier3d::parry::query::details::ShapeCastOptions;
use rapier3d::parry::query::{ShapeCastHit, ShapeCastStatus};

use crate::pair::Pair;
use crate::real::{core_pose, core_real, real, vector};

/// Advances of a shape cast before it gives up.
const CAST_STEPS: usize = 64;

/// Conservative advancement: as long as the shapes are apart, neither can meet the other sooner
/// than their distance divided by their closing speed. From afar what a distance may be off is taken
/// from it; close by, where that is more than the distance, half of it.
///
/// Shapes that cannot meet in time are not looked at closer than that.
pub(crate) fn cast(
    pair: &Pair<'_>,
    pose_at: impl Fn(Real) -> Pose,
    closing_speed: Real,
    start_time: Real,
    options: ShapeCastOptions,
) -> Option<ShapeCastHit> {
    let (near, error) = (real(4.0 * pair.resolution()), real(pair.error()));
    let tolerance = real(1e-4 * pair.size());
    let (target, end_time) = (options.target_distance, options.max_time_of_impact);
    if !options.stop_at_penetration && pair.touches(&core_pose(&pose_at(start_time))) {
        return None;
    }
    // What is further away is not met; the deepest is, should there be anything.
    let closest = |time: Real| {
        let way = closing_speed * (end_time - time).max(0.0);
        let within = core_real(target + way + error + tolerance);
        pair.deepest(&core_pose(&pose_at(time)), within)
    };
    let mut time = start_time;
    let mut status = ShapeCastStatus::OutOfIterations;
    let mut closest_now = closest(time)?;
    if real(-closest_now.penetration) <= target {
        if !options.stop_at_penetration {
            return None;
        }
        status = ShapeCastStatus::PenetratingOrWithinTargetDist;
    } else {
        for _ in 0..CAST_STEPS {
            let free = real(-closest_now.penetration) - target;
            if free <= tolerance {
                status = ShapeCastStatus::Converged;
                break;
            }
            time += (free - error).max(0.5 * free.min(near)) / closing_speed;
            // Also when nothing moves.
            let in_time = time <= end_time;
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
