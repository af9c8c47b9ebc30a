//! Progress of the command: a bar on a terminal, a line now and then in a log.

use std::io::IsTerminal;
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use indicatif::{HumanDuration, ProgressBar, ProgressStyle};

use super::Error;

/// Interval of the lines of a log; shorter tasks leave none.
const LOG_EVERY: Duration = Duration::from_secs(10);

/// Shown until it is dropped.
pub(super) enum Progress {
    Bar(ProgressBar),
    Log(Log),
}

impl Progress {
    /// Progress on standard error.
    pub(super) fn new() -> Result<Self, Error> {
        if !std::io::stderr().is_terminal() {
            return Ok(Self::Log(Log::new(LOG_EVERY, |line| eprintln!("{line}"))));
        }
        let bar = ProgressBar::no_length();
        bar.set_style(ProgressStyle::with_template("{spinner} {msg} ({elapsed})")?);
        bar.enable_steady_tick(Duration::from_millis(100));
        Ok(Self::Bar(bar))
    }

    /// Sets the current task.
    pub(super) fn set(&self, message: String) {
        match self {
            Self::Bar(bar) => bar.set_message(message),
            Self::Log(log) => *log.message.lock().unwrap_or_else(PoisonError::into_inner) = message,
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Self::Bar(bar) = self {
            bar.finish_and_clear();
        }
    }
}

/// A thread that writes the current task until it is dropped.
pub(super) struct Log {
    message: Arc<Mutex<String>>,
    end: Option<Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Log {
    fn new(every: Duration, write: impl Fn(String) + Send + 'static) -> Self {
        let message = Arc::new(Mutex::new(String::new()));
        let (end, ended) = channel();
        let shown = message.clone();
        let start = Instant::now();
        let thread = std::thread::spawn(move || {
            while ended.recv_timeout(every) == Err(RecvTimeoutError::Timeout) {
                let message = shown.lock().unwrap_or_else(PoisonError::into_inner).clone();
                let elapsed = HumanDuration(start.elapsed());
                write(format!("vps-compare: {message} (after {elapsed})"));
            }
        });
        Self {
            message,
            end: Some(end),
            thread: Some(thread),
        }
    }
}

impl Drop for Log {
    fn drop(&mut self) {
        self.end = None;
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_log_gets_the_current_task() {
        let (written, lines) = channel();
        let log = Log::new(Duration::from_millis(1), move |line| {
            let _ = written.send(line);
        });
        let progress = Progress::Log(log);
        for message in ["reading", "measuring"] {
            progress.set(message.to_owned());
            let start = format!("vps-compare: {message} (after ");
            assert!(lines.iter().any(|line| line.starts_with(&start)));
        }
        // Nothing is written once it is dropped, and the thread has ended.
        drop(progress);
        while lines.try_recv().is_ok() {}
        assert!(lines.recv().is_err());
    }
}
