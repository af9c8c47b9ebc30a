//! How many contacts an engine knows again from one step to the next.

use std::collections::HashSet;

use rapier3d::geometry::NEW_CONTACT_BIT;
use rapier3d::prelude::*;

/// Counts, step by step, the contacts that bear something and those of them whose impulse was handed
/// on from the step before.
#[derive(Default)]
pub(crate) struct Kept {
    /// Pairs with contacts that bore something in the step before.
    before: HashSet<[ColliderHandle; 2]>,
    bearing: u64,
    handed_on: u64,
}

impl Kept {
    /// Counts what the solver was given in the last step.
    pub(crate) fn follow(&mut self, world: &PhysicsWorld) {
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
                        self.handed_on += u64::from(!is_new);
                    }
                }
            }
        }
        self.before = now;
    }

    /// The share of contacts that began with an impulse of the step before; `None` of none.
    pub(crate) fn share(&self) -> Option<f64> {
        (self.bearing > 0).then(|| self.handed_on as f64 / self.bearing as f64)
    }
}
