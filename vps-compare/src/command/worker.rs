//! The worker process of an algorithm: it reads the meshes, prepares, and answers a request per
//! line.

use std::io::{BufRead, Write};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use rapier3d::math::{Pose, Rotation, Vector};
use serde::{Deserialize, Serialize};
use vps_compare::{Contacts, Prepared};

use super::args::Args;
use super::catch_panic::catch_panic;
use super::{Error, prepare, problem};

/// The first line of output: the meshes are read and the work begins.
#[derive(Debug, Deserialize, Serialize)]
pub(super) struct Ready;

/// Time, sizes and memory of the prepared meshes.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub(super) struct PreparedInfo {
    pub(super) prepare_s: f64,
    /// Sizes by name, such as a number of points.
    pub(super) size_a: Vec<(String, usize)>,
    pub(super) size_b: Vec<(String, usize)>,
    pub(super) memory_bytes: usize,
    pub(super) memory_is_estimate: bool,
}

/// A pose of B in A between the local frames, and the prediction distance.
#[derive(Debug, Deserialize, Serialize)]
pub(super) struct QueryRequest {
    prediction_m: f64,
    translation: [f64; 3],
    rotation: [f64; 4],
}

/// The contacts at a pose.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub(super) struct QueryResult {
    pub(super) contacts: usize,
    /// Penetration of the deepest contact; `None` if there is none within the prediction.
    pub(super) penetration_m: Option<f64>,
    pub(super) query_ns: u64,
}

/// Total time after which a query is not repeated.
const PATIENCE: Duration = Duration::from_secs(1);

/// Answers requests until there are no more.
pub(super) fn work(name: &str, args: &Args) -> Result<(), Error> {
    let requests = requests();
    let mut algorithms = args.algorithms()?.into_iter();
    let algorithm = algorithms.find(|algorithm| algorithm.key() == name);
    let algorithm = algorithm.ok_or_else(|| format!("`{name}` takes no part"))?;
    let meshes = problem::meshes(&args.meshes)?;
    send(&Ready)?;
    let start = Instant::now();
    let prepared = catch_panic(|| prepare::prepare(&algorithm, args, [&meshes.a, &meshes.b]));
    let prepare_s = start.elapsed().as_secs_f64();
    send(&prepared.as_ref().map(|p| PreparedInfo::of(p, prepare_s)))?;
    let Ok(prepared) = prepared else {
        return Ok(());
    };
    for line in requests {
        let request: QueryRequest = serde_json::from_str(&line)?;
        send(&catch_panic(|| query(&prepared, &request, args.repeat)))?;
    }
    Ok(())
}

/// The lines of standard input. When it ends, this process exits at once: the supervising process
/// has ended, and limits are no longer enforced.
fn requests() -> Receiver<String> {
    let (sender, lines) = channel();
    std::thread::spawn(move || {
        let mut input = std::io::stdin().lock().lines().map_while(Result::ok);
        while input.next().is_some_and(|line| sender.send(line).is_ok()) {}
        std::process::exit(0);
    });
    lines
}

fn send(answer: &impl Serialize) -> Result<(), Error> {
    let mut out = std::io::stdout().lock();
    writeln!(out, "{}", serde_json::to_string(answer)?)?;
    Ok(out.flush()?)
}

/// Queries once to warm up, unless that takes long enough by itself, and then to take the time.
/// Every query starts without earlier contacts, as the pose of a body is new in every step.
fn query(prepared: &Prepared, request: &QueryRequest, repeat: u32) -> Result<QueryResult, String> {
    let (pose, prediction) = (request.pose(), request.prediction_m as f32);
    let begin = Instant::now();
    let mut least: Option<Duration> = None;
    let mut count_and_deepest = (0, None);
    for turn in 0..=repeat {
        let mut contacts = Contacts::default();
        let start = Instant::now();
        let result = prepared.query(&pose, prediction, &mut contacts);
        let took = start.elapsed();
        result.map_err(|_| "unsupported".to_owned())?;
        count_and_deepest = contacts.count_and_deepest();
        let is_long = begin.elapsed() > PATIENCE;
        if turn > 0 || is_long {
            least = Some(least.map_or(took, |l| l.min(took)));
        }
        if is_long {
            break;
        }
    }
    let (contacts, penetration) = count_and_deepest;
    if let Some(p) = penetration.filter(|p| !p.is_finite()) {
        return Err(format!("the penetration is {p}"));
    }
    Ok(QueryResult {
        contacts,
        penetration_m: penetration.map(f64::from),
        query_ns: least.unwrap_or_default().as_nanos() as u64,
    })
}

impl PreparedInfo {
    fn of(prepared: &Prepared, prepare_s: f64) -> Self {
        let named = |size: &vps_compare::Size| {
            let size = size.iter();
            size.map(|(name, n)| ((*name).to_owned(), *n)).collect()
        };
        Self {
            prepare_s,
            size_a: named(&prepared.ground_size),
            size_b: named(&prepared.size),
            memory_bytes: prepared.memory.bytes,
            memory_is_estimate: prepared.memory.is_estimate,
        }
    }
}

impl QueryRequest {
    pub(super) fn of(pose: &Pose, prediction_m: f64) -> Self {
        Self {
            prediction_m,
            translation: pose.translation.to_array().map(f64::from),
            rotation: pose.rotation.to_array().map(f64::from),
        }
    }

    fn pose(&self) -> Pose {
        Pose::from_parts(
            Vector::from_array(self.translation.map(|x| x as f32)),
            Rotation::from_array(self.rotation.map(|x| x as f32)),
        )
    }
}
