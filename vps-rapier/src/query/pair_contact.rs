//! A contact between the surfaces of two shapes.

use rapier3d::parry::query::Contact as ParryContact;
use rapier3d::parry::shape::PackedFeatureId;
use vps_core::{Pose3, Vec3};

use crate::precision::{real, vector};

/// A contact between two surfaces. Entries of arrays belong to the first and to the second shape.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct PairContact {
    /// A point on each surface, in the frame of its shape in metres.
    pub points: [Vec3; 2],
    /// The unit normal out of each shape, in its frame. The two are opposite, and the field's.
    pub normals: [Vec3; 2],
    /// The unit normal out of the first shape by the normal of the shell, in the frame of the first
    /// shape; `None` for points of edges.
    pub shell_normal: Option<Vec3>,
    /// Whether the point belongs to the shell or the edges of the first shape.
    pub shell_is_first: bool,
    /// Feature ids, which identify the contact from step to step.
    pub ids: [PackedFeatureId; 2],
    /// In metres, positive inside.
    pub penetration: f32,
}

impl PairContact {
    /// The same contact with the shapes in the other order.
    pub(crate) fn flipped(self) -> Self {
        let flip = |[a, b]: [Vec3; 2]| [b, a];
        Self {
            points: flip(self.points),
            normals: flip(self.normals),
            shell_normal: None,
            shell_is_first: !self.shell_is_first,
            ids: [self.ids[1], self.ids[0]],
            penetration: self.penetration,
        }
    }

    /// Sets the normal out of the first shape, in the frame of the first. The point of the shell stays
    /// where it is.
    pub(crate) fn set_normal(&mut self, normal: Vec3, pos12: &Pose3) {
        self.normals = [normal, -(pos12.rotation.inverse() * normal)];
        let separation = normal * -self.penetration;
        if self.shell_is_first {
            self.points[1] = pos12.inverse_transform_point(self.points[0] + separation);
        } else {
            self.points[0] = pos12.transform_point(self.points[1]) - separation;
        }
    }

    pub(crate) fn to_parry(self) -> ParryContact {
        let [point1, point2] = self.points.map(vector);
        let [normal1, normal2] = self.normals.map(vector);
        ParryContact::new(point1, point2, normal1, normal2, real(-self.penetration))
    }
}

/// The deeper of two contacts, the first if they are equally deep.
pub(crate) fn deeper(a: PairContact, b: PairContact) -> PairContact {
    if b.penetration > a.penetration { b } else { a }
}

/// The largest penetration of contacts in metres, minus infinity if there are none.
pub(crate) fn max_penetration(contacts: &[PairContact]) -> f32 {
    let depths = contacts.iter().map(|c| c.penetration);
    depths.fold(f32::NEG_INFINITY, f32::max)
}
