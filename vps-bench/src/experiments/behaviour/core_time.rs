//! The time a thread waits for a core.

/// Times of this thread in nanoseconds, where Linux tells them.
#[derive(Clone, Copy, Debug)]
pub(super) struct CoreTime {
    ran: f64,
    /// Ready to run while others had the core.
    waited: f64,
}

impl CoreTime {
    pub(super) fn of_now() -> Self {
        let stat = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
        let mut times = stat.split(' ').map(|n| n.parse().unwrap_or(f64::NAN));
        let [ran, waited] = [(); 2].map(|()| times.next().unwrap_or(f64::NAN));
        Self { ran, waited }
    }

    /// The percentage of the time since then that this thread waited; NaN if it is unknown.
    pub(super) fn waited_percent(self) -> f64 {
        let now = Self::of_now();
        let [ran, waited] = [now.ran - self.ran, now.waited - self.waited];
        100.0 * waited / (ran + waited)
    }
}
