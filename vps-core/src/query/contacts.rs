//! The contact set, and the deepest of it.

use crate::field::DistanceField;
use crate::query::collectors::{All, Any, Deepest};
use crate::query::contact::Contact;
use crate::query::posed::Query;
use crate::query::work::CountWork;
use crate::simd::multiversion::dispatch;

impl<F: DistanceField + ?Sized, W: CountWork> Query<'_, F, W> {
    /// Calls `visit` with every contact, in the order of the points.
    ///
    /// Algorithm 1, with two differences that change no result: the tree is walked depth first
    /// (which needs no queue), and a parent point is tested once, with the leaf it belongs to.
    pub fn for_each_contact(&self, visit: impl FnMut(Contact)) {
        self.find(All::new(self.margin, visit));
    }

    /// Calls `visit` with every contact, testing every point (MPT99): what the tree is measured
    /// against.
    pub fn for_each_contact_flat(&self, visit: impl FnMut(Contact)) {
        if !self.is_posed {
            return;
        }
        let mut all = All::new(self.margin, visit);
        let range = (0, self.tree.point_count() as u32);
        dispatch(
            #[inline(always)]
            || self.offer_points(range, &mut all),
        );
    }

    /// Whether there is any contact; stops at the first.
    pub fn touches(&self) -> bool {
        let mut any = Any {
            margin: self.margin,
            found: false,
        };
        self.find_from_hint(&mut any);
        any.found
    }

    /// The contact with the largest penetration δ, the first of equally deep ones.
    ///
    /// Branch and bound: clusters that cannot hold a deeper point are left out.
    pub fn deepest(&self) -> Option<Contact> {
        let mut deepest = Deepest::new(self.margin);
        self.find_from_hint(&mut deepest);
        deepest.found
    }

    /// The point of the shell with the largest penetration, however far outside: where the bodies
    /// are closest if they are apart, the negative of its penetration being their separation
    /// (section 2.2), and the [`deepest`](Self::deepest) if they are not. `None` only for a pose
    /// that is not finite.
    pub fn closest(&self) -> Option<Contact>
    where
        W: Copy,
    {
        self.with_margin(f32::INFINITY).deepest()
    }

    /// A single point, if it is in contact.
    pub(crate) fn test_point(&self, point: u32) -> Option<Contact> {
        let mut found = Deepest::new(self.margin);
        self.offer_points((point, point + 1), &mut found);
        found.found
    }
}
