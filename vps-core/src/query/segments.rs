//! The deepest contact of each segment.

use crate::field::DistanceField;
use crate::query::collectors::{AllContacts, DeepestContact};
use crate::query::contact::Contact;
use crate::query::observer::Observer;
use crate::query::posed::Query;
use crate::query::search::ROOT;

impl<F: DistanceField + ?Sized, O: Observer> Query<'_, F, O> {
    /// Calls `visit` with the deepest contact of each cluster of a level that has one, in the order
    /// of the clusters: the segmented traverse (section 2.4). The arguments are the index of the
    /// cluster in its level, and the first of equally deep contacts.
    ///
    /// Level 1 has one cluster, and its contact is the [`deepest`](Self::deepest) of all. A level
    /// below the leaves counts as that of the leaves.
    ///
    /// ```
    /// use vps_core::{HalfSpace, PointSphereTree, Pose3, Query, Vec3};
    ///
    /// // The ends of a peg that stands on the ground, one of them 10 mm too deep.
    /// let (low, high) = (Vec3::new(0.0, -0.01, 0.0), Vec3::new(0.0, 0.2, 0.0));
    /// let tree = PointSphereTree::flat(&[low, high], &[Vec3::Y, Vec3::NEG_Y], 1e-4)?;
    /// let ground = HalfSpace::new(Vec3::Y);
    /// let mut found = Vec::new();
    /// Query::new(&tree, &ground, Pose3::IDENTITY)
    ///     .for_each_segment(1, |segment, contact| found.push((segment, contact.point_index)));
    /// assert_eq!(found, [(0, 0)]);
    /// # Ok::<(), vps_core::TreeError>(())
    /// ```
    pub fn for_each_segment(&self, level: u32, mut visit: impl FnMut(u32, Contact)) {
        let level = level.clamp(1, self.tree.level_count());
        let start = self.tree.level_starts()[level as usize - 1];
        let mut all = AllContacts::new(self.prediction, |_| ());
        self.multiversion(
            #[inline(always)]
            || {
                self.descend(
                    ROOT,
                    level,
                    &mut all,
                    #[inline(always)]
                    |segment, _, _| {
                        let mut deepest = DeepestContact::new(self.prediction);
                        self.search((level, segment), &mut deepest);
                        if let Some(deepest) = deepest.found {
                            visit(segment - start, deepest);
                        }
                        true
                    },
                );
            },
        );
    }
}
