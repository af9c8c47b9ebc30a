//! Keeps what is timed on one core.

use crate::job::Shard;

/// Keeps this thread on a core, where the system allows it, and gives its number. Shards that run at
/// the same time on one machine get different ones, as long as there are enough.
pub(crate) fn to_one_core(shard: Shard) -> Option<usize> {
    // Threads inherit the core of the one that starts them: those that build assets start before.
    rayon::broadcast(|_| ());
    let cores = core_affinity::get_core_ids()?;
    // The last ones first: systems like to do their own work on the first.
    let core = cores.iter().rev().cycle().nth(shard.index() - 1)?;
    core_affinity::set_for_current(*core).then_some(core.id)
}
