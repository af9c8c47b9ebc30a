//! A pointshell posed in a distance field.

use glamx::{Mat3, Pose3, Vec3};

use crate::field::DistanceField;
use crate::query::approach::Approach;
use crate::query::observer::Observer;
use crate::shell::PointSphereTree;
use crate::simd::Vectors;
use crate::simd::multiversion::multiversion;

/// A pointshell posed in a distance field (sections 2.2 to 2.4).
///
/// A point is in contact when its penetration is at least 0, or at least −prediction with a
/// [`prediction`](Self::with_prediction).
/// Every query gives the same result as a test of all points
/// ([`for_each_contact_flat`](Self::for_each_contact_flat)), but prunes clusters that cannot change
/// it. With a pose that is not finite there are no contacts.
///
/// ```
/// use vps_core::{HalfSpace, PointSphereTree, Pose3, Query, Vec3};
///
/// // The ends of a peg that stands on the ground, one of them 10 mm too deep.
/// let (low, high) = (Vec3::new(0.0, -0.01, 0.0), Vec3::new(0.0, 0.2, 0.0));
/// let tree = PointSphereTree::flat(&[low, high], &[Vec3::Y, Vec3::NEG_Y], 1e-4)?;
/// let ground = HalfSpace::new(Vec3::Y);
/// let query = Query::new(&tree, &ground, Pose3::IDENTITY);
/// assert!(query.touches());
/// assert_eq!(query.closest().map(|c| c.point_index), Some(0));
/// // Lifted by 20 mm.
/// let above = Query::new(&tree, &ground, Pose3::from_translation(Vec3::Y * 0.02));
/// assert_eq!(above.deepest(), None);
/// assert!((above.closest().unwrap().penetration + 0.01).abs() < 1e-6);
/// # Ok::<(), vps_core::TreeError>(())
/// ```
#[derive(Debug)]
pub struct Query<'q, F: ?Sized, O = ()> {
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
    pub(crate) observer: O,
}

impl<F: ?Sized, O: Copy> Clone for Query<'_, F, O> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<F: ?Sized, O: Copy> Copy for Query<'_, F, O> {}

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
            observer: (),
        }
    }
}

impl<'q, F: DistanceField + ?Sized, O: Observer> Query<'q, F, O> {
    /// The same query with an observer of what it does, in place of its present one: a closure
    /// `Fn(Event)`, or a reference to [`Work`](crate::Work), which counts. The results are the same.
    ///
    /// A query takes longer with an observer; with `()`, the observer of a new query, it costs nothing.
    ///
    /// ```
    /// use vps_core::{HalfSpace, PointSphereTree, Pose3, Query, Vec3, Work};
    ///
    /// // The ends of a peg that stands on the ground, one of them 10 mm too deep.
    /// let (low, high) = (Vec3::new(0.0, -0.01, 0.0), Vec3::new(0.0, 0.2, 0.0));
    /// let tree = PointSphereTree::flat(&[low, high], &[Vec3::Y, Vec3::NEG_Y], 1e-4)?;
    /// let ground = HalfSpace::new(Vec3::Y);
    /// let work = Work::default();
    /// Query::new(&tree, &ground, Pose3::IDENTITY).observed_by(&work).deepest();
    /// assert_eq!(work.points(), 2);
    /// # Ok::<(), vps_core::TreeError>(())
    /// ```
    pub fn observed_by<P: Observer>(&self, observer: P) -> Query<'q, F, P> {
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
            observer,
        }
    }

    /// Speculative distance (`prediction` of parry and rapier): points up to `prediction` metres outside
    /// of the solid count as contacts too; 0 by default.
    ///
    /// ```
    /// use vps_core::{HalfSpace, PointSphereTree, Pose3, Query, Vec3};
    ///
    /// // The ends of a peg that stands on the ground, one of them 10 mm too deep.
    /// let (low, high) = (Vec3::new(0.0, -0.01, 0.0), Vec3::new(0.0, 0.2, 0.0));
    /// let tree = PointSphereTree::flat(&[low, high], &[Vec3::Y, Vec3::NEG_Y], 1e-4)?;
    /// let ground = HalfSpace::new(Vec3::Y);
    /// let above = Query::new(&tree, &ground, Pose3::from_translation(Vec3::Y * 0.02));
    /// assert!(above.deepest().is_none());
    /// assert!(above.with_prediction(0.015).deepest().is_some());
    /// # Ok::<(), vps_core::TreeError>(())
    /// ```
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
    ///
    /// ```
    /// use vps_core::{HalfSpace, PointSphereTree, Pose3, Query, Vec3};
    ///
    /// // The ends of a peg that stands on the ground, one of them 10 mm too deep.
    /// let (low, high) = (Vec3::new(0.0, -0.01, 0.0), Vec3::new(0.0, 0.2, 0.0));
    /// let tree = PointSphereTree::flat(&[low, high], &[Vec3::Y, Vec3::NEG_Y], 1e-4)?;
    /// let ground = HalfSpace::new(Vec3::Y);
    /// let query = Query::new(&tree, &ground, Pose3::IDENTITY);
    /// let before = query.deepest().unwrap();
    /// assert_eq!(query.with_hint(before.point_index).deepest(), Some(before));
    /// # Ok::<(), vps_core::TreeError>(())
    /// ```
    pub fn with_hint(self, point: u32) -> Self {
        let hint = Some(point).filter(|&p| (p as usize) < self.tree.point_count());
        Self { hint, ..self }
    }

    /// Runs a part of the query with the best instruction set of the processor. An observed query is slow
    /// anyway, and compiled for the target's alone.
    #[inline(always)]
    pub(crate) fn multiversion<R>(&self, work: impl FnOnce() -> R) -> R {
        if O::IS_ACTIVE {
            work()
        } else {
            multiversion(work)
        }
    }

    /// Makes events and hands them to the observer, if there is one.
    #[inline(always)]
    pub(crate) fn observe(&self, events: impl FnOnce(&O)) {
        /// Apart from the search, which is compiled for every field, collector and instruction set.
        #[inline(never)]
        fn tell<O>(observer: &O, events: impl FnOnce(&O)) {
            events(observer);
        }
        if O::IS_ACTIVE {
            tell(&self.observer, events);
        }
    }

    #[inline(always)]
    pub(crate) fn to_field(&self, points: Vectors) -> Vectors {
        points
            .rotated(&self.rotation)
            .plus(Vectors::splat(self.translation))
    }
}
