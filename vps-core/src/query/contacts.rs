//! The contact set, its deepest contact, and whether there is any.

use crate::field::DistanceField;
use crate::query::collectors::{AllContacts, AnyContact, DeepestContact};
use crate::query::contact::Contact;
use crate::query::posed::Query;
use crate::query::work::CountWork;
use crate::simd::multiversion::multiversion;

impl<F: DistanceField + ?Sized, W: CountWork> Query<'_, F, W> {
    /// Calls `visit` with every contact, in the order of the points.
    ///
    /// Algorithm 1, with two differences that do not change the result: the tree is traversed depth
    /// first, which needs no queue, and a parent point is tested once, with its leaf.
    pub fn for_each_contact(&self, visit: impl FnMut(Contact)) {
        self.collect(AllContacts::new(self.prediction, visit));
    }

    /// Calls `visit` with every contact, testing every point (MPT99): the reference for the tree.
    pub fn for_each_contact_flat(&self, visit: impl FnMut(Contact)) {
        if !self.has_finite_pose {
            return;
        }
        let mut all = AllContacts::new(self.prediction, visit);
        let range = (0, self.tree.point_count() as u32);
        multiversion(
            #[inline(always)]
            || self.test_points(range, &mut all),
        );
    }

    /// Whether there is any contact; stops at the first.
    pub fn touches(&self) -> bool {
        let mut any = AnyContact {
            prediction: self.prediction,
            found: false,
        };
        self.collect_from_hint(&mut any);
        any.found
    }

    /// The contact with the largest penetration δ, the first of equally deep ones.
    ///
    /// Branch and bound: clusters that cannot contain a deeper point are pruned.
    pub fn deepest(&self) -> Option<Contact> {
        let mut deepest = DeepestContact::new(self.prediction);
        self.collect_from_hint(&mut deepest);
        deepest.found
    }

    /// The point of the shell with the largest penetration, however far outside. If the bodies are
    /// apart it is the closest point, and the negative of its penetration their separation (section
    /// 2.2); otherwise it is the [`deepest`](Self::deepest) contact. `None` only for a pose
    /// that is not finite.
    pub fn closest(&self) -> Option<Contact>
    where
        W: Copy,
    {
        self.with_prediction(f32::INFINITY).deepest()
    }

    /// The contact of a single point, if it is one.
    pub(crate) fn test_point(&self, point: u32) -> Option<Contact> {
        let mut deepest = DeepestContact::new(self.prediction);
        self.test_points((point, point + 1), &mut deepest);
        deepest.found
    }
}
