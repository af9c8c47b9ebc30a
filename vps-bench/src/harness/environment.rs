//! The environment of a run: machine, compiler, versions and revision.

use std::process::Command;

use serde::{Deserialize, Serialize};

use crate::data::checksum::sha256;
use crate::harness::timed_dispatcher::Stopwatch;

/// Machine, compiler, versions and revision of a run.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub(crate) struct Environment {
    /// Seconds since 1970.
    pub(crate) unix_time_s: u64,
    pub(crate) processor: String,
    pub(crate) logical_cores: usize,
    /// The core the run was pinned to, if it was.
    #[serde(default)]
    pub(crate) core: Option<usize>,
    /// The scheduling of this thread, such as `real time`; empty if it is unknown.
    #[serde(default)]
    pub(crate) scheduling: String,
    /// Threads that ran or were ready to run in the minute before, on average.
    #[serde(default)]
    pub(crate) load_average: Option<f64>,
    pub(crate) memory_mib: u64,
    pub(crate) system: String,
    pub(crate) kernel: String,
    pub(crate) target: String,
    pub(crate) rustc: String,
    pub(crate) profile: String,
    pub(crate) opt_level: String,
    pub(crate) version: String,
    pub(crate) rapier3d: String,
    pub(crate) parry3d: String,
    /// Revision of this project, with `+` if files were changed since; empty outside of a checkout.
    pub(crate) revision: String,
    /// Overhead of timing a query, contained in every time.
    pub(crate) timer_overhead_ns: u64,
    /// SHA-256 of the executable.
    pub(crate) program: String,
}

impl Environment {
    /// The first difference that forbids times of both in one table: processor, compiler, profile
    /// or versions. `None` if they are the same, whichever machine took the times.
    pub(crate) fn difference(&self, other: &Self) -> Option<String> {
        let text = |(name, a, b)| format!("{name} is `{a}` here and `{b}` there");
        self.different(other).map(text).next()
    }

    /// All differences between two environments A and B, a line each.
    pub(crate) fn differences(&self, other: &Self) -> Vec<String> {
        let text = |(name, a, b)| format!("{name}: `{a}` in A, `{b}` in B");
        self.different(other).map(text).collect()
    }

    fn different(&self, other: &Self) -> impl Iterator<Item = (&'static str, String, String)> {
        let of = |e: &Self| {
            [
                ("processor", e.processor.clone()),
                ("target", e.target.clone()),
                ("compiler", e.rustc.clone()),
                (
                    "profile",
                    format!("{}, opt-level {}", e.profile, e.opt_level),
                ),
                ("version", e.version.clone()),
                ("revision", e.revision.clone()),
                ("rapier3d", e.rapier3d.clone()),
                ("parry3d", e.parry3d.clone()),
            ]
        };
        let both = of(self).into_iter().zip(of(other));
        let different = both.filter(|(a, b)| a != b);
        different.map(|((name, a), (_, b))| (name, a, b))
    }

    /// The environment of this run, pinned to `core` or to none.
    pub(crate) fn of_now(core: Option<usize>) -> Self {
        let machine = sysinfo::System::new().map(|mut system| {
            system.refresh_memory();
            system.refresh_cpu_all();
            let processor = system.cpus().first().map(|c| c.brand().trim().to_owned());
            (processor, system.cpus().len(), system.total_memory() >> 20)
        });
        let (processor, logical_cores, memory_mib) = machine.unwrap_or_default();
        let unknown = || "unknown".to_owned();
        Self {
            unix_time_s: std::time::SystemTime::now()
                .duration_since(std::time::UNIX_EPOCH)
                .map_or(0, |d| d.as_secs()),
            processor: processor.unwrap_or_else(unknown),
            logical_cores,
            core,
            scheduling: scheduling().into(),
            load_average: sysinfo::System::load_average().ok().map(|load| load.one),
            memory_mib,
            system: sysinfo::System::long_os_version().unwrap_or_else(|_| unknown()),
            kernel: sysinfo::System::kernel_version().unwrap_or_else(|_| unknown()),
            target: env!("VPS_TARGET").into(),
            rustc: env!("VPS_RUSTC").into(),
            profile: env!("VPS_PROFILE").into(),
            opt_level: env!("VPS_OPT_LEVEL").into(),
            version: env!("CARGO_PKG_VERSION").into(),
            rapier3d: env!("VPS_RAPIER3D").into(),
            parry3d: env!("VPS_PARRY3D").into(),
            revision: revision().unwrap_or_default(),
            timer_overhead_ns: Stopwatch::overhead_ns(),
            program: program(),
        }
    }
}

/// The scheduling of this thread, where Linux tells it.
fn scheduling() -> &'static str {
    let stat = std::fs::read_to_string("/proc/thread-self/stat").unwrap_or_default();
    // The 41st field of proc_pid_stat(5): the 39th behind the name, which ends with a bracket.
    let (_, fields) = stat.rsplit_once(')').unwrap_or_default();
    match fields.split_whitespace().nth(38) {
        Some("0") => "ordinary",
        Some("1" | "2") => "real time",
        _ => "",
    }
}

/// SHA-256 of the executable; empty if it cannot be read.
fn program() -> String {
    let bytes = std::env::current_exe().and_then(std::fs::read);
    bytes.map_or_else(|_| String::new(), |bytes| sha256(&bytes))
}

fn revision() -> Option<String> {
    let git = |arguments: &[&str]| {
        let output = Command::new("git").args(arguments).output().ok()?;
        output.status.success().then_some(output.stdout)
    };
    let mut revision = String::from_utf8(git(&["rev-parse", "HEAD"])?)
        .ok()?
        .trim()
        .to_owned();
    // Files written by runs do not count as changes.
    let changes = git(&[
        "status",
        "--porcelain",
        "--",
        ".",
        ":!reports",
        ":!README.md",
    ])?;
    if !changes.is_empty() {
        revision.push('+');
    }
    Some(revision)
}
