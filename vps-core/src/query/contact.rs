//! A shell point found in a field.

use glamx::Vec3;

use crate::shell::PointSphereTree;

/// A shell point found in the field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Index of the point in the shell.
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
