//! A loop of 1 kHz in real time.

use std::hint::spin_loop;
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Time of a cycle.
pub(super) const PERIOD: Duration = Duration::from_millis(1);
/// The same in seconds.
pub(super) const DT: f32 = 1e-3;
/// Time before a deadline from which on the loop does not sleep.
const AWAKE: Duration = Duration::from_micros(200);

/// A cycle of the loop.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cycle<T> {
    /// The time it began after it was due.
    pub(super) late: Duration,
    /// The time it took.
    pub(super) duration: Duration,
    pub(super) result: T,
}

/// Makes a cycle every millisecond; one that is late begins at once.
pub(super) fn in_real_time<T>(cycles: usize, mut cycle: impl FnMut(usize) -> T) -> Vec<Cycle<T>> {
    let mut all = Vec::with_capacity(cycles);
    let start = Instant::now() + 20 * PERIOD;
    for i in 0..cycles {
        let due = start + i as u32 * PERIOD;
        let asleep = due.saturating_duration_since(Instant::now() + AWAKE);
        if !asleep.is_zero() {
            sleep(asleep);
        }
        while Instant::now() < due {
            spin_loop();
        }
        let began = Instant::now();
        let result = cycle(i);
        all.push(Cycle {
            late: began - due,
            duration: began.elapsed(),
            result,
        });
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cycle_begins_when_it_is_due_and_never_before() {
        let start = Instant::now();
        let cycles = in_real_time(20, |i| (i, start.elapsed()));
        assert_eq!(cycles.len(), 20);
        for (i, cycle) in cycles.iter().enumerate() {
            assert_eq!(cycle.result.0, i);
            let due = (20 + i as u32) * PERIOD;
            assert!(cycle.result.1 >= due, "cycle {i} began too early");
        }
    }
}
