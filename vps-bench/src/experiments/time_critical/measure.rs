//! Compares a query that is ended early with the complete one.

use std::time::{Duration, Instant};

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rapier3d::math::{Pose, Vector};
use serde::Serialize;
use vps_core::{DistanceField, Estimate, PointSphereTree, Query, Vec3, Weight};

use super::{Limit, Settings};
use crate::data::stats::Sample;
use crate::experiments::shared::orientation::orientation_of;
use crate::harness::context::Body;

/// The results of a batch of poses; errors are against the complete query.
#[derive(Clone, Debug, Serialize)]
pub(super) struct BatchRow {
    poses: usize,
    /// Number of complete queries.
    complete: usize,
    /// Deepest penetration minus that of the deepest contact found.
    penetration_error_mm_median: f64,
    penetration_error_mm_p99: f64,
    penetration_error_mm_max: f64,
    /// Bound on the penetration minus the deepest penetration.
    bound_error_mm_median: f64,
    bound_error_mm_p99: f64,
    bound_error_mm_max: f64,
    /// Length of the difference of forces, relative to the force where there is one.
    force_error_median: Option<f64>,
    force_error_p99: Option<f64>,
    force_error_max: Option<f64>,
    query_us_median: f64,
    query_us_p99: f64,
    query_us_max: f64,
    /// Queries that ended after their deadline, and the largest overrun.
    overruns: Option<usize>,
    overrun_us_max: Option<f64>,
    /// Queries among them that end late in every repetition.
    late_by_itself: Option<usize>,
    /// The same for a loop that only reads the clock: the jitter of the machine.
    idle_loops: Option<usize>,
    idle_overruns: Option<usize>,
    idle_overrun_us_max: Option<f64>,
}

/// Poses of a batch, shell to field.
pub(super) struct Poses(Vec<Pose>);

impl Poses {
    /// Random poses of a body in the ground.
    pub(super) fn of(settings: &Settings, body: &Body, batch: u32) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(settings.seed.wrapping_add(u64::from(batch)));
        let [from, to] = settings.depth_m;
        let upper_side = 0.5 * settings.ground_extents_m[1];
        let poses = (0..settings.poses_per_batch).map(|_| {
            let rotation = orientation_of(rng.random());
            let [x, z, depth]: [f64; 3] = rng.random();
            let aside = |share: f64| (settings.aside_m * (2.0 * share - 1.0)) as f32;
            let turned = Pose::from_parts(Vector::ZERO, rotation);
            let depth = from + depth * (to - from);
            let height = f64::from(body.oracle.penetration(&turned, 0.0)) - depth;
            let at = Vector::new(aside(x), (upper_side + height) as f32, aside(z));
            Pose::from_parts(at, rotation)
        });
        Self(poses.collect())
    }
}

/// Number of queries before the first measured one, to warm the caches.
const WARM_UP: usize = 200;

/// Of queries with a deadline, one in this many is checked for errors and followed by an idle loop.
const SAMPLE_EVERY: usize = 10;

/// Attempts at a query that ends late: if none ends in time, the query is late by itself.
const TRIES: usize = 10;

/// Queries all poses.
///
/// # Errors
/// When the query breaks its contract: a contact deeper than the deepest, or a bound below it.
pub(super) fn measure<F: DistanceField>(
    settings: &Settings,
    limit: Limit,
    tree: &PointSphereTree<'_>,
    field: &F,
    center: Vec3,
    poses: &Poses,
) -> Result<BatchRow, String> {
    for pose in poses.0.iter().take(WARM_UP) {
        std::hint::black_box(Query::new(tree, field, *pose).time_critical(center, |_| true));
    }
    let mut errors = Errors::default();
    let mut timing = Timing::default();
    for (number, pose) in poses.0.iter().enumerate() {
        let (estimate, took) = query_once(settings, limit, tree, field, center, pose);
        timing.record_query(took, limit, || {
            query_once(settings, limit, tree, field, center, pose).1
        });
        errors.complete += usize::from(estimate.is_complete);
        let Limit::Deadline(deadline) = limit else {
            errors.add(&Query::new(tree, field, *pose), center, &estimate)?;
            continue;
        };
        if number % SAMPLE_EVERY == 0 {
            errors.add(&Query::new(tree, field, *pose), center, &estimate)?;
            let start = Instant::now();
            let end = start + settings.stop_after(deadline);
            while Instant::now() < end {}
            timing.record_idle_loop(start.elapsed(), deadline);
        }
    }
    Ok(row(limit, errors, timing))
}

/// Queries once and returns the time as well.
fn query_once<F: DistanceField>(
    settings: &Settings,
    limit: Limit,
    tree: &PointSphereTree<'_>,
    field: &F,
    center: Vec3,
    pose: &Pose,
) -> (Estimate, Duration) {
    let start = Instant::now();
    let query = Query::new(tree, field, *pose);
    let estimate = match limit {
        Limit::Points(points) => query.time_critical(center, |tested| tested < points),
        Limit::None => query.time_critical(center, |_| true),
        Limit::Deadline(deadline) => {
            let end = start + settings.stop_after(deadline);
            let mut asked = 0;
            query.time_critical(center, |_| {
                asked += 1;
                asked % settings.clock_every != 0 || Instant::now() < end
            })
        }
    };
    (estimate, start.elapsed())
}

fn row(limit: Limit, errors: Errors, timing: Timing) -> BatchRow {
    let poses = timing.query_us.len();
    let penetration = quantiles(errors.penetration_mm).map(Option::unwrap_or_default);
    let bound = quantiles(errors.bound_mm).map(Option::unwrap_or_default);
    let force = quantiles(errors.force);
    let query = quantiles(timing.query_us).map(Option::unwrap_or_default);
    let has_deadline = matches!(limit, Limit::Deadline(_));
    BatchRow {
        poses,
        complete: errors.complete,
        penetration_error_mm_median: penetration[0],
        penetration_error_mm_p99: penetration[1],
        penetration_error_mm_max: penetration[2],
        bound_error_mm_median: bound[0],
        bound_error_mm_p99: bound[1],
        bound_error_mm_max: bound[2],
        force_error_median: force[0],
        force_error_p99: force[1],
        force_error_max: force[2],
        query_us_median: query[0],
        query_us_p99: query[1],
        query_us_max: query[2],
        overruns: has_deadline.then_some(timing.overruns),
        overrun_us_max: has_deadline.then_some(timing.overrun_us_max),
        late_by_itself: has_deadline.then_some(timing.late_by_itself),
        idle_loops: has_deadline.then_some(timing.idle_loops),
        idle_overruns: has_deadline.then_some(timing.idle_overruns),
        idle_overrun_us_max: has_deadline.then_some(timing.idle_overrun_us_max),
    }
}

/// Median, 99th percentile and largest.
fn quantiles(values: Vec<f64>) -> [Option<f64>; 3] {
    let sample = Sample::of(values);
    [sample.median(), sample.quantile(0.99), sample.max()]
}

/// Errors of estimates.
#[derive(Default)]
struct Errors {
    penetration_mm: Vec<f64>,
    bound_mm: Vec<f64>,
    force: Vec<f64>,
    complete: usize,
}

impl Errors {
    fn add<F: DistanceField>(
        &mut self,
        query: &Query<'_, F>,
        center: Vec3,
        estimate: &Estimate,
    ) -> Result<(), String> {
        let depth = |contact: Option<vps_core::Contact>| contact.map_or(0.0, |c| c.penetration);
        let deepest = depth(query.deepest());
        let wrench = query.wrench(center, Weight::Area);
        let too_little = f64::from(deepest - depth(estimate.deepest)) * 1e3;
        let too_much = f64::from(estimate.penetration_bound - deepest) * 1e3;
        if too_little < 0.0 || too_much < 0.0 {
            return Err(format!(
                "penetration {deepest} m is estimated to be from {} to {} m",
                depth(estimate.deepest),
                estimate.penetration_bound
            ));
        }
        self.penetration_mm.push(too_little);
        self.bound_mm.push(too_much);
        let force = wrench.force.length();
        if force > 0.0 {
            let difference = estimate.wrench.force.distance(wrench.force);
            self.force.push(f64::from(difference / force));
        }
        Ok(())
    }
}

/// Times of queries and overruns of deadlines.
#[derive(Default)]
struct Timing {
    query_us: Vec<f64>,
    overruns: usize,
    overrun_us_max: f64,
    late_by_itself: usize,
    idle_loops: usize,
    idle_overruns: usize,
    idle_overrun_us_max: f64,
}

impl Timing {
    fn record_query(&mut self, took: Duration, limit: Limit, mut again: impl FnMut() -> Duration) {
        self.query_us.push(took.as_secs_f64() * 1e6);
        if let Limit::Deadline(deadline) = limit
            && took > deadline
        {
            self.overruns += 1;
            self.overrun_us_max = self.overrun_us_max.max(overrun_us(took, deadline));
            let is_late = (1..TRIES).all(|_| again() > deadline);
            self.late_by_itself += usize::from(is_late);
        }
    }

    fn record_idle_loop(&mut self, took: Duration, deadline: Duration) {
        self.idle_loops += 1;
        if took > deadline {
            self.idle_overruns += 1;
            self.idle_overrun_us_max = self.idle_overrun_us_max.max(overrun_us(took, deadline));
        }
    }
}

fn overrun_us(took: Duration, deadline: Duration) -> f64 {
    (took - deadline).as_secs_f64() * 1e6
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_query_is_late_by_itself_if_it_never_ends_in_time() {
        let us = Duration::from_micros;
        let limit = Limit::Deadline(us(100));
        let mut timing = Timing::default();
        timing.record_query(us(100), limit, || us(500));
        assert_eq!((timing.overruns, timing.late_by_itself), (0, 0));
        let mut tries = 0;
        timing.record_query(us(130), limit, || {
            tries += 1;
            us(if tries == TRIES - 1 { 90 } else { 101 })
        });
        assert_eq!((timing.overruns, timing.late_by_itself), (1, 0));
        timing.record_query(us(120), limit, || us(101));
        assert_eq!((timing.overruns, timing.late_by_itself), (2, 1));
        assert!((timing.overrun_us_max - 30.0).abs() < 1e-6);
        timing.record_query(us(9000), Limit::None, || us(9000));
        assert_eq!((timing.overruns, timing.query_us.len()), (2, 4));
    }
}
