//! A pointshell posed in a distance field.

use glamx::{Mat3, Pose3, Vec3};

use crate::field::DistanceField;
use crate::query::approach::Approach;
use crate::query::work::{CountWork, Work};
use crate::shell::PointSphereTree;
use crate::simd::Vectors;

/// A pointshell posed in a distance field (sections 2.2 to 2.4).
///
/// A point is in contact when its penetration is at least 0, or at least −prediction with a
/// [`prediction`](Self::with_prediction).
/// Every query gives the same result as a test of all points
/// ([`for_each_contact_flat`](Self::for_each_contact_flat)), but prunes clusters that cannot change
/// it. With a pose that is not finite there are no contacts.
#[derive(Debug)]
pub struct Query<'q, F: ?Sized, W = ()> {
    pub(crate) tree: &'q PointSphereTree<'q>,
    pub(crate) field: &'q F,
    pub(crate) rotation: Mat3,
    pub(crate) translation: Vec3,
    pub(crate) has_finite_pose: bool,
    pub(crate) prediction: f32,
    pub(crate) approach: Approach,
    /// Index of the point that is tested first.
    pub(crate) hint: Option<u32>,
    /// Padding of balls in metres: rounding moves a ball and its points differently.
    pub(crate) rounding_slack: f32,
    pub(crate) work: W,
}

impl<F: ?Sized, W: Copy> Clone for Query<'_, F, W> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<F: ?Sized, W: Copy> Copy for Query<'_, F, W> {}

impl<'q, F: DistanceField + ?Sized> Query<'q, F> {
    /// A query for contacts; `shell_to_field` transforms shell coordinates to field coordinates.
    pub fn new(tree: &'q PointSphereTree<'q>, field: &'q F, shell_to_field: Pose3) -> Self {
        let translation = shell_to_field.translation;
        let reach = tree.origin_distance_bound() + translation.length();
        Self {
            tree,
            field,
            rotation: Mat3::from_quat(shell_to_field.rotation),
            translation,
            has_finite_pose: shell_to_field.is_finite(),
            prediction: 0.0,
            approach: Approach::RESTING,
            hint: None,
            rounding_slack: 16.0 * f32::EPSILON * reach,
            work: (),
        }
    }

    /// The same query, counting the clusters and points it tests.
    pub fn counting<'w>(self, work: &'w Work) -> Query<'q, F, &'w Work> {
        Query {
            tree: self.tree,
            field: self.field,
            rotation: self.rotation,
            translation: self.translation,
            has_finite_pose: self.has_finite_pose,
            prediction: self.prediction,
            approach: self.approach,
            hint: self.hint,
            rounding_slack: self.rounding_slack,
            work,
        }
    }
}

impl<F: DistanceField + ?Sized, W: CountWork> Query<'_, F, W> {
    /// Speculative distance (`prediction` of parry and rapier): points up to `prediction` metres outside
    /// of the solid count as contacts too; 0 by default.
    pub fn with_prediction(self, prediction: f32) -> Self {
        Self { prediction, ..self }
    }

    /// Tells [`manifold`](Self::manifold) how the shell came to its pose, so that contacts of the
    /// next step count; [`Approach::RESTING`] by default.
    pub fn with_approach(self, approach: Approach) -> Self {
        Self { approach, ..self }
    }

    /// Has [`touches`](Self::touches), [`deepest`](Self::deepest) and [`manifold`](Self::manifold)
    /// test a point first that is likely to be deep, such as the deepest of the previous step (a
    /// warm start). The result is the same. An index out of range is ignored.
    pub fn with_hint(self, point: u32) -> Self {
        let hint = Some(point).filter(|&p| (p as usize) < self.tree.point_count());
        Self { hint, ..self }
    }

    #[inline(always)]
    pub(crate) fn to_field(&self, points: Vectors) -> Vectors {
        points
            .rotated(&self.rotation)
            .plus(Vectors::splat(self.translation))
    }
}
