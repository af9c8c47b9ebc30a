//! Every algorithm at every pose.

use std::time::{Duration, Instant};

use indicatif::ProgressBar;
use rapier3d::math::Pose;
use serde::Serialize;
use vps_compare::oracle::Exact;
use vps_compare::{Contacts, Prepared};

use super::algorithms::Candidate;
use super::guard::guarded;
use super::setting::Setting;

/// What an algorithm said at a pose.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Row {
    /// Counted from 1.
    pub(super) pose: usize,
    pub(super) x_m: f32,
    pub(super) y_m: f32,
    pub(super) z_m: f32,
    pub(super) qx: f32,
    pub(super) qy: f32,
    pub(super) qz: f32,
    pub(super) qw: f32,
    pub(super) algorithm: String,
    /// `ok`, or why there is no answer.
    pub(super) status: String,
    pub(super) contacts: Option<usize>,
    /// Of the deepest contact; empty if there is none within the prediction.
    pub(super) penetration_m: Option<f64>,
    pub(super) query_ns: Option<u64>,
    pub(super) exact_penetration_m: f64,
    pub(super) exact_uncertainty_m: f64,
    /// How far the two penetrations are from each other.
    pub(super) error_m: Option<f64>,
    /// Empty if there is no answer.
    pub(super) answer: Option<Answer>,
}

/// Whether the solids touch, as an algorithm has it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Answer {
    Right,
    /// They overlap by more than the tolerance, and no touch was found.
    Missed,
    /// They are apart by more than the tolerance, and a touch was found.
    FalseTouch,
}

/// No query is repeated once its repetitions took this long.
const PATIENCE: Duration = Duration::from_secs(1);

/// Asks all algorithms, pose by pose, so that a slow minute of the machine meets all.
pub(super) fn measure(
    setting: &Setting,
    candidates: &[Candidate],
    repeat: u32,
    progress: &ProgressBar,
) -> Vec<Row> {
    let mut rows = Vec::new();
    for (i, (pose, exact)) in setting.poses.iter().enumerate() {
        for candidate in candidates {
            let number = i + 1;
            let count = setting.poses.len();
            progress.set_message(format!("pose {number} of {count}: {}", candidate.name));
            let asked = match &candidate.prepared {
                Ok(prepared) => ask(prepared, pose, setting.prediction_m as f32, repeat),
                Err(why) => Err(why.clone()),
            };
            let name = candidate.name.to_string();
            rows.push(Row::of(
                number,
                pose,
                exact,
                setting.tolerance_m,
                name,
                asked,
            ));
        }
    }
    rows
}

struct Asked {
    contacts: usize,
    penetration_m: Option<f64>,
    query_ns: u64,
}

/// Asks once to warm up, and then for the time: every time anew, without contacts of a step before,
/// as the pose of a body is new in every step.
fn ask(prepared: &Prepared, pose: &Pose, prediction: f32, repeat: u32) -> Result<Asked, String> {
    guarded(|| {
        let begin = Instant::now();
        let mut least: Option<Duration> = None;
        let mut summary = (0, None);
        for turn in 0..=repeat {
            let mut contacts = Contacts::default();
            let start = Instant::now();
            let result = prepared.query(pose, prediction, &mut contacts);
            let took = start.elapsed();
            result.map_err(|_| "unsupported".to_owned())?;
            summary = contacts.summary();
            let is_warm = turn > 0;
            if is_warm {
                least = Some(least.map_or(took, |l| l.min(took)));
                if begin.elapsed() > PATIENCE {
                    break;
                }
            }
        }
        let (contacts, penetration) = summary;
        if let Some(p) = penetration.filter(|p| !p.is_finite()) {
            return Err(format!("the penetration is {p}"));
        }
        Ok(Asked {
            contacts,
            penetration_m: penetration.map(f64::from),
            query_ns: least.unwrap_or_default().as_nanos() as u64,
        })
    })
}

impl Row {
    fn of(
        number: usize,
        pose: &Pose,
        exact: &Exact,
        tolerance_m: f64,
        algorithm: String,
        asked: Result<Asked, String>,
    ) -> Self {
        let answer = |asked: &Asked| {
            let touches = asked.penetration_m.is_some_and(|p| p >= 0.0);
            if !touches && exact.penetration_m > tolerance_m {
                Answer::Missed
            } else if touches && exact.penetration_m < -tolerance_m {
                Answer::FalseTouch
            } else {
                Answer::Right
            }
        };
        let status = asked.as_ref().err().cloned();
        let asked = asked.ok();
        let penetration_m = asked.as_ref().and_then(|a| a.penetration_m);
        Self {
            pose: number,
            x_m: pose.translation.x,
            y_m: pose.translation.y,
            z_m: pose.translation.z,
            qx: pose.rotation.x,
            qy: pose.rotation.y,
            qz: pose.rotation.z,
            qw: pose.rotation.w,
            algorithm,
            status: status.unwrap_or_else(|| "ok".into()),
            contacts: asked.as_ref().map(|a| a.contacts),
            penetration_m,
            query_ns: asked.as_ref().map(|a| a.query_ns),
            exact_penetration_m: exact.penetration_m,
            exact_uncertainty_m: exact.uncertainty_m,
            error_m: penetration_m.map(|p| (p - exact.penetration_m).abs()),
            answer: asked.as_ref().map(answer),
        }
    }
}
