//! A haptic loop of 1 kHz in real time, in two scenes: a stylus that probes the bunny, and a peg that
//! goes into a hole. Poses of the device are scripted. Writes how many deadlines were missed, how
//! long everything took and what was felt, into `reports/haptics`: `just haptics`.

mod report;
mod scenes;

use std::hint::{black_box, spin_loop};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::thread::sleep;
use std::time::{Duration, Instant};

use vps_core::{Pose3, Query, VirtualCoupling, Weight, Wrench};

use crate::report::Scheduling;
use crate::scenes::Scene;

type Error = Box<dyn std::error::Error>;

/// Time of a cycle.
const PERIOD: Duration = Duration::from_millis(1);
/// The same in seconds.
const DT: f32 = 1e-3;
/// From when before a deadline on the loop does not sleep.
const AWAKE: Duration = Duration::from_micros(200);
/// Cycles that come before those that count.
const BEFORE: usize = 500;
/// How often each query is asked again afterwards; the shortest time counts.
const REPLAYS: u32 = 5;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let run = Options::parse(&arguments).and_then(|options| options.run());
    match run {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("haptic_loop: {error}");
            ExitCode::from(2)
        }
    }
}

/// What is asked for.
struct Options {
    seconds: u32,
    out: PathBuf,
}

impl Options {
    fn parse(arguments: &[String]) -> Result<Self, Error> {
        let mut options = Self {
            seconds: 10,
            out: Path::new(env!("CARGO_MANIFEST_DIR")).join("../reports/haptics"),
        };
        let mut arguments = arguments.iter();
        while let Some(option) = arguments.next() {
            let value = arguments.next();
            match (option.as_str(), value) {
                ("--seconds", Some(value)) => {
                    let seconds = value.parse().ok().filter(|s| (1..=3600).contains(s));
                    options.seconds =
                        seconds.ok_or_else(|| format!("--seconds needs 1 to 3600, not {value}"))?;
                }
                ("--out", Some(value)) => options.out = value.into(),
                ("--seconds" | "--out", None) => {
                    return Err(format!("{option} needs a value").into());
                }
                _ => return Err(format!("no {option}; there are --seconds N and --out DIR").into()),
            }
        }
        Ok(options)
    }

    fn run(&self) -> Result<(), Error> {
        let cycles = self.seconds as usize * 1000;
        let scenes = scenes::all()?;
        let scheduling = Scheduling::of_this_thread();
        println!("nothing: {} s", self.seconds);
        let nothing = in_real_time(cycles, |_| Felt::default());
        let mut runs = Vec::new();
        for scene in &scenes {
            println!(
                "{}, {} voxelmap: {} s",
                scene.name, scene.store, self.seconds
            );
            let samples = scene.run(cycles)?;
            let replayed = scene.replay(&samples);
            runs.push(report::Run {
                scene,
                samples,
                replayed,
            });
        }
        report::write(&self.out, &nothing, &runs, &scheduling)
    }
}

/// What came of a cycle.
#[derive(Clone, Copy, Debug, Default)]
struct Sample {
    /// How long after it was due it began, and how long it took.
    late: Duration,
    cycle: Duration,
    felt: Felt,
}

impl Sample {
    /// Whether it ended later than the next was due.
    fn is_miss(&self) -> bool {
        self.late + self.cycle > PERIOD
    }
}

/// What a cycle found out.
#[derive(Clone, Copy, Debug, Default)]
struct Felt {
    device: Pose3,
    /// Where the tool was when contacts were asked for.
    tool: Pose3,
    /// What the device exerts.
    wrench: Wrench,
    collision: Duration,
}

/// What asking again told of a cycle.
#[derive(Clone, Copy, Debug)]
struct Replayed {
    collision: Duration,
    /// For force and torque alone.
    wrench: Duration,
    contacts: usize,
    /// Of the deepest contact, in metres; 0 for none.
    penetration: f32,
}

/// Makes a cycle every millisecond; one that is late begins at once.
fn in_real_time(cycles: usize, mut cycle: impl FnMut(usize) -> Felt) -> Vec<Sample> {
    let mut samples = vec![Sample::default(); cycles];
    let start = Instant::now() + 20 * PERIOD;
    for (i, sample) in samples.iter_mut().enumerate() {
        let due = start + i as u32 * PERIOD;
        let asleep = due.saturating_duration_since(Instant::now() + AWAKE);
        if !asleep.is_zero() {
            sleep(asleep);
        }
        while Instant::now() < due {
            spin_loop();
        }
        let began = Instant::now();
        let felt = cycle(i);
        *sample = Sample {
            late: began - due,
            cycle: began.elapsed(),
            felt,
        };
    }
    samples
}

impl Scene {
    fn run(&self, cycles: usize) -> Result<Vec<Sample>, Error> {
        let field = self.solid.voxelmap.trilinear();
        let tool = self.coupling.tool;
        let before = self.device.len().saturating_sub(BEFORE);
        let start = self.device[before];
        let mut coupling = VirtualCoupling::new(tool, self.coupling.options, start)?;
        let mut refused = None;
        let mut cycle = |i: usize| {
            let device = self.device[i % self.device.len()];
            let pose = coupling.pose();
            let asked = Instant::now();
            // The solid's frame is the world.
            let contact =
                Query::new(&self.tool.tree, &field, pose).linear_wrench(tool.center, Weight::Area);
            let collision = asked.elapsed();
            let contact = (contact * self.stiffness).rotated(pose.rotation);
            let stepped = coupling.step(device, contact, DT);
            refused = refused.or(stepped.err());
            Felt {
                device,
                tool: pose,
                wrench: coupling.rendered(),
                collision,
            }
        };
        // The end of the loop leads to its beginning; besides, what is used first is slow.
        for i in before..self.device.len() {
            cycle(i);
        }
        let samples = in_real_time(cycles, cycle);
        match refused {
            Some(error) => Err(format!("{}: {error}", self.name).into()),
            None => Ok(samples),
        }
    }

    /// Asks the same queries again, with all the time in the world.
    fn replay(&self, samples: &[Sample]) -> Vec<Replayed> {
        let field = self.solid.voxelmap.trilinear();
        let center = self.coupling.tool.center;
        let replayed = |sample: &Sample| {
            let query = Query::new(&self.tool.tree, &field, sample.felt.tool);
            let linear = || _ = black_box(query.linear_wrench(center, Weight::Area));
            let wrench = || _ = black_box(query.wrench(center, Weight::Area));
            let mut contacts = 0;
            query.for_each_contact(|_| contacts += 1);
            Replayed {
                collision: shortest(linear),
                wrench: shortest(wrench),
                contacts,
                penetration: query.deepest().map_or(0.0, |c| c.penetration),
            }
        };
        samples.iter().map(replayed).collect()
    }
}

/// The shortest time something takes.
fn shortest(ask: impl Fn()) -> Duration {
    let once = |_| {
        let asked = Instant::now();
        ask();
        asked.elapsed()
    };
    (0..REPLAYS).map(once).min().unwrap_or_default()
}
