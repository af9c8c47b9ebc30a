//! An algorithm at work, in a process of its own: it reads the meshes, prepares, and answers a
//! question a line.

use std::io::{BufRead, Write};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use rapier3d::math::{Pose, Rotation, Vector};
use serde::{Deserialize, Serialize};
use vps_compare::{Contacts, Prepared};

use super::args::{Args, Name};
use super::guard::guarded;
use super::{Error, algorithms, setting};

/// The first line of an answer: the meshes are read, the work begins.
#[derive(Debug, Deserialize, Serialize)]
pub(super) struct Ready;

/// What became of the two meshes.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub(super) struct Made {
    pub(super) prepare_s: f64,
    /// Numbers by name, such as that of points.
    pub(super) size_a: Vec<(String, usize)>,
    pub(super) size_b: Vec<(String, usize)>,
    pub(super) memory_bytes: usize,
    pub(super) memory_is_estimate: bool,
}

/// Where B is in the frame of A, and how far ahead contacts are asked for.
#[derive(Debug, Deserialize, Serialize)]
pub(super) struct Question {
    prediction_m: f64,
    translation: [f64; 3],
    rotation: [f64; 4],
}

/// What there is at a pose.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub(super) struct Asked {
    pub(super) contacts: usize,
    /// Of the deepest contact; `None` if there is none within the prediction.
    pub(super) penetration_m: Option<f64>,
    pub(super) query_ns: u64,
}

/// No query is repeated once its repetitions took this long.
const PATIENCE: Duration = Duration::from_secs(1);

/// Works until there are no more questions.
pub(super) fn work(name: Name, args: &Args) -> Result<(), Error> {
    let questions = questions();
    let (ground, body) = setting::meshes(args)?;
    say(&Ready)?;
    let start = Instant::now();
    let prepared = guarded(|| algorithms::prepare(name, args, [&ground, &body]));
    let prepare_s = start.elapsed().as_secs_f64();
    say(&prepared.as_ref().map(|p| Made::of(p, prepare_s)))?;
    let Ok(prepared) = prepared else {
        return Ok(());
    };
    for line in questions {
        let question: Question = serde_json::from_str(&line)?;
        say(&guarded(|| ask(&prepared, &question, args.repeat)))?;
    }
    Ok(())
}

/// The lines of standard input. Where that ends, so does this process, whatever it is at: the one that
/// asks has ended, and nobody keeps to limits.
fn questions() -> Receiver<String> {
    let (sender, lines) = channel();
    std::thread::spawn(move || {
        let mut input = std::io::stdin().lock().lines().map_while(Result::ok);
        while input.next().is_some_and(|line| sender.send(line).is_ok()) {}
        std::process::exit(0);
    });
    lines
}

fn say(answer: &impl Serialize) -> Result<(), Error> {
    let mut out = std::io::stdout().lock();
    writeln!(out, "{}", serde_json::to_string(answer)?)?;
    Ok(out.flush()?)
}

/// Asks once to warm up, unless that takes long enough by itself, and then for the time: every time
/// anew, without contacts of a step before, as the pose of a body is new in every step.
fn ask(prepared: &Prepared, question: &Question, repeat: u32) -> Result<Asked, String> {
    let (pose, prediction) = (question.pose(), question.prediction_m as f32);
    let begin = Instant::now();
    let mut least: Option<Duration> = None;
    let mut summary = (0, None);
    for turn in 0..=repeat {
        let mut contacts = Contacts::default();
        let start = Instant::now();
        let result = prepared.query(&pose, prediction, &mut contacts);
        let took = start.elapsed();
        result.map_err(|_| "unsupported".to_owned())?;
        summary = contacts.summary();
        let is_long = begin.elapsed() > PATIENCE;
        if turn > 0 || is_long {
            least = Some(least.map_or(took, |l| l.min(took)));
        }
        if is_long {
            break;
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
}

impl Made {
    fn of(prepared: &Prepared, prepare_s: f64) -> Self {
        let memory = prepared.memory();
        let named = |size: &vps_compare::Size| {
            let size = size.iter();
            size.map(|(name, n)| ((*name).to_owned(), *n)).collect()
        };
        Self {
            prepare_s,
            size_a: named(&prepared.ground_size),
            size_b: named(&prepared.size),
            memory_bytes: memory.bytes,
            memory_is_estimate: memory.is_estimate,
        }
    }
}

impl Question {
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
