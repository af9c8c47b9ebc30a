//! A shell point found in a field.

use glamx::Vec3;

use crate::shell::PointSphereTree;

/// A shell point found in the field, or the point of the surface it is [refined](crate::Query::refine) to.
///
/// ```
/// use vps_core::{HalfSpace, PointSphereTree, Pose3, Query, Vec3};
///
/// // The ends of a peg that stands on the ground, one of them 10 mm too deep.
/// let (low, high) = (Vec3::new(0.0, -0.01, 0.0), Vec3::new(0.0, 0.2, 0.0));
/// let tree = PointSphereTree::flat(&[low, high], &[Vec3::Y, Vec3::NEG_Y], 1e-4)?;
/// let ground = HalfSpace::new(Vec3::Y);
/// let contact = Query::new(&tree, &ground, Pose3::IDENTITY).deepest().unwrap();
/// assert_eq!((contact.point_index, contact.position, contact.normal), (0, low, Vec3::Y));
/// assert!((contact.penetration - 0.01).abs() < 1e-6);
/// # Ok::<(), vps_core::TreeError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Index of the point in the shell, also of a refined contact.
    pub point_index: u32,
    /// Its position P in metres in the shell frame.
    pub position: Vec3,
    /// Its unit inward normal n in the shell frame: the direction in which the shell's body
    /// is pushed (eq. 2).
    pub normal: Vec3,
    /// Its penetration V in metres, positive inside; negative only within the prediction
    /// distance of a query.
    pub penetration: f32,
}

impl Contact {
    /// The contact of a point of a shell.
    #[inline(always)]
    pub(crate) fn of(tree: &PointSphereTree<'_>, point: u32, penetration: f32) -> Self {
        Self {
            point_index: point,
            position: tree.point(point as usize),
            normal: tree.normal(point as usize),
            penetration,
        }
    }

    /// Whether it is deeper than another contact, if there is one. Of equally deep ones the first
    /// point counts as deeper.
    #[inline]
    pub(crate) fn is_deeper_than(&self, other: Option<&Self>) -> bool {
        other.is_none_or(|other| {
            self.penetration > other.penetration
                || self.penetration == other.penetration && self.point_index < other.point_index
        })
    }
}
