//! An algorithm in a supervised process, which is ended if it exceeds its limits.

use std::io::{BufRead, BufReader, Write};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::{Duration, Instant};

use serde::de::DeserializeOwned;

use super::Error;
use super::args::Args;
use super::worker::{PreparedInfo, QueryRequest, QueryResult, Ready};

/// Interval of checks of a working process.
const CHECK_INTERVAL: Duration = Duration::from_millis(20);

/// An algorithm, prepared or failed.
pub(super) struct Candidate {
    pub(super) name: &'static str,
    pub(super) prepare_s: f64,
    pub(super) made: Result<PreparedInfo, String>,
    worker: WorkerProcess,
}

impl Candidate {
    /// Prepares an algorithm, which uses a part of its budget.
    pub(super) fn prepare(name: &'static str, args: &Args) -> Result<Self, Error> {
        let mut worker = WorkerProcess::start(name, args)?;
        let made: Result<PreparedInfo, String> = worker.receive().and_then(|Ready| {
            // Reading the meshes is not counted.
            worker.spent = Duration::ZERO;
            worker.receive().and_then(|made| made)
        });
        let taken_s = worker.spent.as_secs_f64();
        Ok(Self {
            name,
            prepare_s: made.as_ref().map_or(taken_s, |made| made.prepare_s),
            made,
            worker,
        })
    }

    /// Queries the contacts at a pose.
    pub(super) fn query(&mut self, request: &QueryRequest) -> Result<QueryResult, String> {
        self.made.as_ref().map_err(String::clone)?;
        self.worker.send(request)?;
        self.worker.receive().and_then(|result| result)
    }
}

/// A worker process, the time it has spent, and its limits.
struct WorkerProcess {
    child: Child,
    input: ChildStdin,
    lines: Receiver<String>,
    time_limit_s: f64,
    memory_limit_mib: u64,
    spent: Duration,
    /// The reason why it was ended.
    ended: Option<String>,
}

impl WorkerProcess {
    fn start(name: &str, args: &Args) -> Result<Self, Error> {
        let mut child = Command::new(std::env::current_exe()?)
            .arg(format!("--worker={name}"))
            .args(std::env::args_os().skip(1))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()?;
        let pipes = child.stdin.take().zip(child.stdout.take());
        let (input, output) = pipes.ok_or("a process without pipes")?;
        let (sender, lines) = channel();
        // Ends with the process.
        std::thread::spawn(move || {
            for line in BufReader::new(output).lines().map_while(Result::ok) {
                if sender.send(line).is_err() {
                    break;
                }
            }
        });
        Ok(Self {
            child,
            input,
            lines,
            time_limit_s: args.time_limit,
            memory_limit_mib: args.memory_limit,
            spent: Duration::ZERO,
            ended: None,
        })
    }

    fn send(&mut self, request: &QueryRequest) -> Result<(), String> {
        let line = serde_json::to_string(request).map_err(|e| e.to_string())?;
        // A process that has ended does not read it; the reason is found when its answer is
        // received.
        let _ = writeln!(self.input, "{line}").and_then(|()| self.input.flush());
        Ok(())
    }

    /// Waits for a line, within the limits.
    fn receive<T: DeserializeOwned>(&mut self) -> Result<T, String> {
        self.check(Duration::ZERO);
        let begin = Instant::now();
        let line = self.wait(begin);
        self.spent += begin.elapsed();
        serde_json::from_str(&line?).map_err(|e| e.to_string())
    }

    fn wait(&mut self, begin: Instant) -> Result<String, String> {
        loop {
            if let Some(why) = &self.ended {
                return Err(why.clone());
            }
            match self.lines.recv_timeout(CHECK_INTERVAL) {
                Ok(line) => return Ok(line),
                Err(RecvTimeoutError::Timeout) => self.check(begin.elapsed()),
                Err(RecvTimeoutError::Disconnected) => {
                    let status = self.child.wait().map_err(|e| e.to_string())?;
                    self.ended = Some(format!("its process ended: {status}"));
                }
            }
        }
    }

    /// Ends the process if with `more` time spent it exceeds its limits.
    fn check(&mut self, more: Duration) {
        let memory = peak_memory_mib(self.child.id());
        let (time_s, memory_mib) = (self.time_limit_s, self.memory_limit_mib);
        if (self.spent + more).as_secs_f64() > time_s {
            self.end(format!("ended after {time_s} s, its --time-limit"));
        } else if memory.is_some_and(|mib| mib > memory_mib) {
            self.end(format!("ended at {memory_mib} MiB, its --memory-limit"));
        }
    }

    fn end(&mut self, why: String) {
        let _ = self.child.kill();
        let _ = self.child.wait();
        self.ended = Some(why);
    }
}

impl Drop for WorkerProcess {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// The peak memory of a process, where the system reports it (Linux).
fn peak_memory_mib(process: u32) -> Option<u64> {
    let status = std::fs::read_to_string(format!("/proc/{process}/status")).ok()?;
    let peak = status
        .lines()
        .find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kib: u64 = peak.split_whitespace().next()?.parse().ok()?;
    Some(kib / 1024)
}
