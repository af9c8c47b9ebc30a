//! Summarizes the rows of each algorithm.

use std::path::Path;

use serde::{Serialize, Serializer};
use vps_build::Mesh;

use super::args::Args;
use super::candidate::Candidate;
use super::measure::{Answer, Row};
use super::problem::Problem;

/// The result of the command: the problem, and a summary of each algorithm.
#[derive(Serialize)]
pub(super) struct Comparison {
    pub(super) version: &'static str,
    pub(super) mesh_a: MeshSummary,
    pub(super) mesh_b: MeshSummary,
    /// The file of the poses; without it they are random.
    pub(super) poses_file: Option<String>,
    pub(super) seed: Option<u64>,
    pub(super) spread_m: Option<f64>,
    pub(super) poses: usize,
    pub(super) apart: usize,
    pub(super) overlapping: usize,
    pub(super) prediction_m: f64,
    pub(super) tolerance_m: f64,
    pub(super) repeat: u32,
    /// Number of poses whose exact penetration is known to within `exact_uncertainty_m`.
    pub(super) exact: usize,
    pub(super) exact_uncertainty_m: Option<f64>,
    /// Why it is not known at all poses.
    pub(super) inexact: Option<String>,
    pub(super) algorithms: Vec<AlgorithmSummary>,
}

#[derive(Serialize)]
pub(super) struct MeshSummary {
    pub(super) file: String,
    pub(super) triangles: usize,
    pub(super) extents_m: [f64; 3],
    /// Whether it was a solid without repair; otherwise exact values are those of the repaired
    /// mesh.
    pub(super) watertight: bool,
    /// Whether its holes were left open, so that nothing is exact.
    pub(super) open: bool,
}

/// Sizes and measurements of an algorithm. Times, contacts and errors are of answered queries.
#[derive(Serialize)]
pub(super) struct AlgorithmSummary {
    pub(super) algorithm: String,
    /// `ok`, or the reason of the first query without an answer.
    pub(super) status: String,
    /// Sizes of A and B by name, such as a number of points.
    #[serde(serialize_with = "as_map")]
    pub(super) size_a: Vec<(String, usize)>,
    #[serde(serialize_with = "as_map")]
    pub(super) size_b: Vec<(String, usize)>,
    pub(super) prepare_s: f64,
    pub(super) memory_bytes: Option<usize>,
    pub(super) memory_is_estimate: Option<bool>,
    pub(super) answered: usize,
    pub(super) query_median_ns: Option<f64>,
    pub(super) query_p99_ns: Option<f64>,
    pub(super) contacts_mean: Option<f64>,
    /// Number of poses with a contact to compare.
    pub(super) compared: usize,
    pub(super) error_median_m: Option<f64>,
    pub(super) error_max_m: Option<f64>,
    /// Number of poses at which it is known whether the answer is right.
    pub(super) judged: usize,
    pub(super) missed: usize,
    pub(super) false_touches: usize,
}

impl Comparison {
    pub(super) fn of(
        args: &Args,
        problem: &Problem,
        candidates: &[Candidate],
        rows: &[Row],
    ) -> Self {
        let exact = || problem.poses.iter().filter_map(|pose| pose.exact);
        let (certain, uncertain): (Vec<_>, Vec<_>) = exact()
            .map(|e| (problem.is_certain(&e), e.uncertainty_m))
            .partition(|(is_certain, _)| *is_certain);
        let most = |of: &[(bool, f64)]| of.iter().map(|(_, m)| *m).reduce(f64::max);
        let open = match problem.is_open {
            [true, true] => Some("A and B"),
            [true, false] => Some("A"),
            [false, true] => Some("B"),
            [false, false] => None,
        };
        let open = open.map(|which| {
            format!("holes of {which} were left open, so that inside and outside are a guess")
        });
        let given_up = most(&uncertain).map(|most| {
            format!(
                "at the others the search for the deepest point was given up, which may be \
                 {most:.1e} m deeper than what was found"
            )
        });
        let algorithm = |candidate| AlgorithmSummary::of(candidate, rows);
        Self {
            version: env!("CARGO_PKG_VERSION"),
            mesh_a: MeshSummary::of(&args.meshes.mesh_a, &problem.meshes.a, problem, 0),
            mesh_b: MeshSummary::of(&args.meshes.mesh_b, &problem.meshes.b, problem, 1),
            poses_file: args.poses.as_ref().map(|path| path.display().to_string()),
            seed: args.poses.is_none().then_some(args.seed),
            spread_m: problem.spread_m,
            poses: problem.poses.len(),
            apart: exact().filter(|e| e.penetration_m < 0.0).count(),
            overlapping: exact().filter(|e| e.penetration_m > 0.0).count(),
            prediction_m: problem.prediction_m,
            tolerance_m: problem.tolerance_m,
            repeat: args.repeat,
            exact: certain.len(),
            exact_uncertainty_m: most(&certain),
            inexact: open.or(given_up),
            algorithms: candidates.iter().map(algorithm).collect(),
        }
    }
}

impl MeshSummary {
    /// The summary of the first or the second mesh.
    fn of(path: &Path, mesh: &Mesh, problem: &Problem, which: usize) -> Self {
        let (low, high) = mesh.bounds();
        Self {
            file: path.display().to_string(),
            triangles: mesh.triangles().len(),
            extents_m: (high - low).to_array(),
            watertight: problem.watertight[which],
            open: problem.is_open[which],
        }
    }
}

impl AlgorithmSummary {
    fn of(candidate: &Candidate, rows: &[Row]) -> Self {
        let algorithm = candidate.name.to_string();
        let rows: Vec<_> = rows.iter().filter(|r| r.algorithm == algorithm).collect();
        let sorted = |value: &dyn Fn(&Row) -> Option<f64>| {
            let mut values: Vec<f64> = rows.iter().filter_map(|row| value(row)).collect();
            values.sort_by(f64::total_cmp);
            values
        };
        let times = sorted(&|row| row.query_ns.map(|ns| ns as f64));
        let errors = sorted(&|row| row.error_m);
        let contacts = sorted(&|row| row.contacts.map(|n| n as f64));
        let failed = rows.iter().find(|row| row.status != "ok");
        let count = |answer| rows.iter().filter(|r| r.answer == Some(answer)).count();
        let made = candidate.made.as_ref().ok();
        let answers = rows.iter().filter_map(|row| row.answer);
        Self {
            status: failed.map_or_else(|| "ok".into(), |row| row.status.clone()),
            size_a: made.map_or_else(Vec::new, |m| m.size_a.clone()),
            size_b: made.map_or_else(Vec::new, |m| m.size_b.clone()),
            prepare_s: candidate.prepare_s,
            memory_bytes: made.map(|m| m.memory_bytes),
            memory_is_estimate: made.map(|m| m.memory_is_estimate),
            answered: times.len(),
            query_median_ns: quantile(&times, 0.5),
            query_p99_ns: quantile(&times, 0.99),
            contacts_mean: (!contacts.is_empty())
                .then(|| contacts.iter().sum::<f64>() / contacts.len() as f64),
            compared: errors.len(),
            error_median_m: quantile(&errors, 0.5),
            error_max_m: errors.last().copied(),
            judged: answers.filter(|a| *a != Answer::Unknown).count(),
            missed: count(Answer::Missed),
            false_touches: count(Answer::FalseTouch),
            algorithm,
        }
    }
}

fn as_map<S: Serializer>(size: &[(String, usize)], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_map(size.iter().map(|(name, number)| (name, number)))
}

/// The quantile `part` from 0 to 1, interpolated between neighbours.
fn quantile(sorted: &[f64], part: f64) -> Option<f64> {
    let place = part * (sorted.len().checked_sub(1)?) as f64;
    let (low, high) = (
        sorted[place.floor() as usize],
        sorted[place.ceil() as usize],
    );
    Some(low + (high - low) * place.fract())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles() {
        assert_eq!(quantile(&[], 0.5), None);
        assert_eq!(quantile(&[7.0], 0.99), Some(7.0));
        assert_eq!(quantile(&[1.0, 2.0, 4.0, 8.0], 0.5), Some(3.0));
        let hundred: Vec<f64> = (0..=100).map(f64::from).collect();
        assert_eq!(quantile(&hundred, 0.99), Some(99.0));
    }
}
