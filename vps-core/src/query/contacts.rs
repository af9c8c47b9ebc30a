//! The contact set, its deepest contact, and whether there is any.

use crate::field::DistanceField;
use crate::query::collectors::{AllContacts, AnyContact, DeepestContact};
use crate::query::contact::Contact;
use crate::query::observer::Observer;
use crate::query::posed::Query;

impl<F: DistanceField + ?Sized, O: Observer> Query<'_, F, O> {
    /// Calls `visit` with every contact, in the order of the points.
    ///
    /// Algorithm 1, with two differences that do not change the result: the tree is traversed depth
    /// first, which needs no queue, and a parent point is tested once, with its leaf.
    ///
    /// ```
    /// use vps_core::{HalfSpace, PointSphereTree, Pose3, Query, Vec3};
    ///
    /// // The ends of a peg that stands on the ground, one of them 10 mm too deep.
    /// let (low, high) = (Vec3::new(0.0, -0.01, 0.0), Vec3::new(0.0, 0.2, 0.0));
    /// let tree = PointSphereTree::flat(&[low, high], &[Vec3::Y, Vec3::NEG_Y], 1e-4)?;
    /// let ground = HalfSpace::new(Vec3::Y);
    /// let mut depths = Vec::new();
    /// Query::new(&tree, &ground, Pose3::IDENTITY)
    ///     .with_prediction(1.0)
    ///     .for_each_contact(|contact| depths.push(contact.penetration));
    /// assert_eq!(depths, [0.01, -0.2]);
    /// # Ok::<(), vps_core::TreeError>(())
    /// ```
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
        self.multiversion(
            #[inline(always)]
            || self.test_points(range, &mut all),
        );
    }

    /// Whether there is any contact; stops at the first.
    ///
    /// ```
    /// use vps_core::{HalfSpace, PointSphereTree, Pose3, Query, Vec3};
    ///
    /// // The ends of a peg that stands on the ground, one of them 10 mm too deep.
    /// let (low, high) = (Vec3::new(0.0, -0.01, 0.0), Vec3::new(0.0, 0.2, 0.0));
    /// let tree = PointSphereTree::flat(&[low, high], &[Vec3::Y, Vec3::NEG_Y], 1e-4)?;
    /// let ground = HalfSpace::new(Vec3::Y);
    /// assert!(Query::new(&tree, &ground, Pose3::IDENTITY).touches());
    /// assert!(!Query::new(&tree, &ground, Pose3::from_translation(Vec3::Y)).touches());
    /// # Ok::<(), vps_core::TreeError>(())
    /// ```
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
    ///
    /// ```
    /// use vps_core::{HalfSpace, PointSphereTree, Pose3, Query, Vec3};
    ///
    /// // The ends of a peg that stands on the ground, one of them 10 mm too deep.
    /// let (low, high) = (Vec3::new(0.0, -0.01, 0.0), Vec3::new(0.0, 0.2, 0.0));
    /// let tree = PointSphereTree::flat(&[low, high], &[Vec3::Y, Vec3::NEG_Y], 1e-4)?;
    /// let ground = HalfSpace::new(Vec3::Y);
    /// let deepest = Query::new(&tree, &ground, Pose3::IDENTITY).deepest();
    /// assert_eq!(deepest.map(|c| c.penetration), Some(0.01));
    /// # Ok::<(), vps_core::TreeError>(())
    /// ```
    pub fn deepest(&self) -> Option<Contact> {
        let mut deepest = DeepestContact::new(self.prediction);
        self.collect_from_hint(&mut deepest);
        deepest.found
    }

    /// The point of the shell with the largest penetration, however far outside. If the bodies are
    /// apart it is the closest point, and the negative of its penetration their separation (section
    /// 2.2); otherwise it is the [`deepest`](Self::deepest) contact. `None` only for a pose
    /// that is not finite.
    ///
    /// ```
    /// use vps_core::{HalfSpace, PointSphereTree, Pose3, Query, Vec3};
    ///
    /// // The ends of a peg that stands on the ground, one of them 10 mm too deep.
    /// let (low, high) = (Vec3::new(0.0, -0.01, 0.0), Vec3::new(0.0, 0.2, 0.0));
    /// let tree = PointSphereTree::flat(&[low, high], &[Vec3::Y, Vec3::NEG_Y], 1e-4)?;
    /// let ground = HalfSpace::new(Vec3::Y);
    /// let above = Pose3::from_translation(Vec3::Y);
    /// let separation = -Query::new(&tree, &ground, above).closest().unwrap().penetration;
    /// assert!((separation - 0.99).abs() < 1e-6);
    /// # Ok::<(), vps_core::TreeError>(())
    /// ```
    pub fn closest(&self) -> Option<Contact>
    where
        O: Copy,
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
