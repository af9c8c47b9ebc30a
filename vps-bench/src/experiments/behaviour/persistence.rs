//! How many contacts persist from one step to the next.

use std::collections::HashSet;

use rapier3d::geometry::NEW_CONTACT_BIT;
use rapier3d::prelude::*;

/// Counts, step by step, the contacts with an impulse, and those of them that were warm started: the
/// solver began with their impulse of the step before.
#[derive(Default)]
pub(super) struct Persistence {
    /// Pairs with an impulse in the step before.
    before: HashSet<[ColliderHandle; 2]>,
    bearing: u64,
    warm_started: u64,
}

impl Persistence {
    /// Counts the contacts the solver was given in the last step.
    pub(super) fn follow(&mut self, world: &PhysicsWorld) {
        let mut now = HashSet::new();
        for pair in world.contact_pairs() {
            let handles = [pair.collider1, pair.collider2];
            let was_bearing = self.before.contains(&handles);
            for manifold in pair.solver_manifolds() {
                for contact in &manifold.data.solver_contacts {
                    let [index] = contact.contact_indices();
                    if manifold.points[index as usize].data.impulse == 0.0 {
                        continue;
                    }
                    now.insert(handles);
                    if was_bearing {
                        let is_new = contact.contact_id[0] & NEW_CONTACT_BIT != 0;
                        self.bearing += 1;
                        self.warm_started += u64::from(!is_new);
                    }
                }
            }
        }
        self.before = now;
    }

    /// The percentage of contacts that were warm started, of pairs with an impulse in the step
    /// before; `None` if there were none.
    pub(super) fn percent(&self) -> Option<f64> {
        (self.bearing > 0).then(|| 100.0 * self.warm_started as f64 / self.bearing as f64)
    }
}
