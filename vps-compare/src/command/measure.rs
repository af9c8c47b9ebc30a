//! Measures every algorithm at every pose.

use serde::Serialize;
use vps_compare::oracle::ExactPenetration;

use super::candidate::Candidate;
use super::problem::{Problem, ProblemPose};
use super::progress::Progress;
use super::worker::{QueryRequest, QueryResult};

/// The answer of an algorithm at a pose.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Row {
    /// Counted from 1.
    pub(super) pose: usize,
    pub(super) x_m: f64,
    pub(super) y_m: f64,
    pub(super) z_m: f64,
    pub(super) qx: f64,
    pub(super) qy: f64,
    pub(super) qz: f64,
    pub(super) qw: f64,
    pub(super) algorithm: String,
    /// `ok`, or why there is no answer.
    pub(super) status: String,
    pub(super) contacts: Option<usize>,
    /// Penetration of the deepest contact; empty if there is none within the prediction.
    pub(super) penetration_m: Option<f64>,
    pub(super) query_ns: Option<u64>,
    /// Empty if a mesh is open.
    pub(super) exact_penetration_m: Option<f64>,
    /// How much larger the exact penetration may be.
    pub(super) exact_uncertainty_m: Option<f64>,
    /// Absolute difference of the two penetrations; empty if the exact one is uncertain.
    pub(super) error_m: Option<f64>,
    /// Verdict on the touch; empty without an answer.
    pub(super) answer: Option<Answer>,
}

/// Whether the algorithm is right that the solids touch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Answer {
    Right,
    /// They overlap by more than the tolerance, and no touch was found.
    Missed,
    /// They are apart by more than the tolerance, and a touch was found.
    FalseTouch,
    /// The exact penetration is uncertain.
    Unknown,
}

/// Queries all algorithms, pose by pose, so that a slow minute of the machine affects all of them.
pub(super) fn measure(
    problem: &Problem,
    candidates: &mut [Candidate],
    progress: &Progress,
) -> Vec<Row> {
    let mut rows = Vec::new();
    let count = problem.poses.len();
    for (number, pose) in (1..).zip(&problem.poses) {
        let request = QueryRequest::of(&pose.local, problem.prediction_m);
        for candidate in &mut *candidates {
            progress.set(format!("pose {number} of {count}: {}", candidate.name));
            let result = candidate.query(&request);
            let name = candidate.name.to_string();
            rows.push(Row::of(number, pose, problem, name, result));
        }
    }
    rows
}

impl Row {
    fn of(
        number: usize,
        pose: &ProblemPose,
        problem: &Problem,
        algorithm: String,
        result: Result<QueryResult, String>,
    ) -> Self {
        let (of_meshes, exact) = (&pose.of_meshes, pose.exact.as_ref());
        let status = result.as_ref().err().cloned();
        let result = result.ok();
        let penetration_m = result.as_ref().and_then(|a| a.penetration_m);
        let certain = exact.filter(|exact| problem.is_certain(exact));
        let error = |(found, exact): (f64, &ExactPenetration)| (found - exact.penetration_m).abs();
        Self {
            pose: number,
            x_m: of_meshes.translation.x,
            y_m: of_meshes.translation.y,
            z_m: of_meshes.translation.z,
            qx: of_meshes.rotation.x,
            qy: of_meshes.rotation.y,
            qz: of_meshes.rotation.z,
            qw: of_meshes.rotation.w,
            algorithm,
            status: status.unwrap_or_else(|| "ok".into()),
            contacts: result.as_ref().map(|a| a.contacts),
            penetration_m,
            query_ns: result.as_ref().map(|a| a.query_ns),
            exact_penetration_m: exact.map(|e| e.penetration_m),
            exact_uncertainty_m: exact.map(|e| e.uncertainty_m),
            error_m: penetration_m.zip(certain).map(error),
            answer: result.map(|_| Answer::of(penetration_m, certain, problem.tolerance_m)),
        }
    }
}

impl Answer {
    fn of(
        penetration_m: Option<f64>,
        certain: Option<&ExactPenetration>,
        tolerance_m: f64,
    ) -> Self {
        let Some(exact) = certain else {
            return Self::Unknown;
        };
        let touches = penetration_m.is_some_and(|p| p >= 0.0);
        if !touches && exact.penetration_m > tolerance_m {
            Self::Missed
        } else if touches && exact.penetration_m < -tolerance_m {
            Self::FalseTouch
        } else {
            Self::Right
        }
    }
}
