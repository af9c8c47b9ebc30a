//! A time limit for steps that may never end.

use std::sync::mpsc::channel;
use std::time::Duration;

use super::record::Record;

/// Longest wait for a scene that may never end.
const PATIENCE: Duration = Duration::from_secs(30);

/// Plays a scene on a thread of its own. A step of the engine cannot be interrupted: if it takes too
/// long the thread is left to itself, and runs until the program ends.
pub(super) fn patiently(
    play: impl FnOnce() -> Result<Record, String> + Send + 'static,
) -> Result<Record, String> {
    let (sender, receiver) = channel();
    // The receiver may be gone by then.
    std::thread::spawn(move || drop(sender.send(play())));
    let played = receiver.recv_timeout(PATIENCE);
    played.unwrap_or_else(|_| Ok(Record::unfinished()))
}
