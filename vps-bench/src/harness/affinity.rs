//! Pins the timed thread to one core.

use crate::harness::job::Shard;

/// Pins this thread to a core, if the system allows it, and returns the core's number. Shards that
/// run at the same time on one machine get different cores, as long as there are enough.
pub(crate) fn pin_to_core(shard: Shard) -> Option<usize> {
    // Threads inherit the affinity of the thread that starts them: those that build assets start
    // first.
    rayon::broadcast(|_| ());
    let cores = core_affinity::get_core_ids()?;
    // The last cores first: systems tend to do their own work on the first.
    let core = cores.iter().rev().cycle().nth(shard.index() - 1)?;
    core_affinity::set_for_current(*core).then_some(core.id)
}
