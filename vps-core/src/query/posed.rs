//! A pointshell posed in a distance field.

use glamx::{Mat3, Pose3, Vec3};

use crate::field::DistanceField;
use crate::query::work::{CountWork, Work};
use crate::shell::PointSphereTree;
use crate::simd::Vectors;

/// A pointshell posed in a distance field (sections 2.2 to 2.4).
///
/// A point is in contact when its penetration is at least 0, or at least −margin. Every query
/// gives the same as a test of all points
/// ([`for_each_contact_flat`](Self::for_each_contact_flat)), but looks only at what may matter to
/// it. With a pose that is not finite there are no contacts.
#[derive(Debug)]
pub struct Query<'q, F: ?Sized, W = ()> {
    pub(crate) tree: &'q PointSphereTree<'q>,
    pub(crate) field: &'q F,
    pub(crate) rotation: Mat3,
    pub(crate) translation: Vec3,
    /// Whether the pose is finite.
    pub(crate) is_posed: bool,
    pub(crate) margin: f32,
    pub(crate) motion: Option<f32>,
    /// A point to begin with.
    pub(crate) hint: Option<u32>,
    /// A ball and the points in it are moved by rounding, each on its own.
    pub(crate) ball_slack: f32,
    pub(crate) work: W,
}

impl<F: ?Sized, W: Copy> Clone for Query<'_, F, W> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<F: ?Sized, W: Copy> Copy for Query<'_, F, W> {}

impl<'q, F: DistanceField + ?Sized> Query<'q, F> {
    /// A query for contacts; `shell_to_field` takes shell coordinates to field coordinates.
    pub fn new(tree: &'q PointSphereTree<'q>, field: &'q F, shell_to_field: Pose3) -> Self {
        let translation = shell_to_field.translation;
        let reach = tree.reach() + translation.length();
        Self {
            tree,
            field,
            rotation: Mat3::from_quat(shell_to_field.rotation),
            translation,
            is_posed: shell_to_field.is_finite(),
            margin: 0.0,
            motion: Some(0.0),
            hint: None,
            ball_slack: 16.0 * f32::EPSILON * reach,
            work: (),
        }
    }

    /// The same query, counting what it looks at.
    pub fn counting<'w>(self, work: &'w Work) -> Query<'q, F, &'w Work> {
        Query {
            tree: self.tree,
            field: self.field,
            rotation: self.rotation,
            translation: self.translation,
            is_posed: self.is_posed,
            margin: self.margin,
            motion: self.motion,
            hint: self.hint,
            ball_slack: self.ball_slack,
            work,
        }
    }
}

impl<F: DistanceField + ?Sized, W: CountWork> Query<'_, F, W> {
    /// Also gives the points that are up to `margin` metres away from the solid.
    pub fn with_margin(self, margin: f32) -> Self {
        Self { margin, ..self }
    }

    /// Tells [`manifold`](Self::manifold) how far the shell has come, towards the solid or away, since
    /// the query before, in metres; 0 without it. `None` if it was further away than the margin: then
    /// it is taken to go as far again as its deepest point is away.
    pub fn with_motion(self, motion: Option<f32>) -> Self {
        Self { motion, ..self }
    }

    /// Has [`touches`](Self::touches), [`deepest`](Self::deepest) and
    /// [`manifold`](Self::manifold) begin with a point that is likely to be deep, such as the deepest
    /// of the step before. What they give is the same; of a point there is not, nothing comes.
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
