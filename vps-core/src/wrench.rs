use glamx::Vec3;

use crate::work::CountWork;
use crate::{Contact, DistanceField, Query};

/// The penalty force and torque of a contact set (eqs. 2 and 3), for stiffness one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wrench {
    /// Sum of wVn over the contacts: newtons once multiplied by a stiffness.
    pub force: Vec3,
    /// Sum of r × wVn with r from the point the torque is about.
    pub torque: Vec3,
}

/// What each contact counts in a [`Wrench`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Weight {
    /// One, as in eqs. 2 and 3: the force is in metres, the stiffness in N/m. Twice the points
    /// push twice as hard.
    #[default]
    Point,
    /// The area its point stands for: the force is in m³, the stiffness in N/m³, a pressure per
    /// depth. Does not depend on the sampling, which section 2.2 asks for.
    Area,
}

impl Weight {
    /// The weight of a point that stands for so much area.
    #[inline]
    pub(crate) fn of(self, area: f32) -> f32 {
        match self {
            Self::Point => 1.0,
            Self::Area => area,
        }
    }
}

impl Wrench {
    /// Adds what a contact does to the shell's body about `center`, in the shell frame; nothing for
    /// one outside of the solid.
    #[inline]
    pub(crate) fn add(&mut self, contact: &Contact, weight: f32, center: Vec3) {
        let force = weight * contact.penetration.max(0.0) * contact.normal;
        self.force += force;
        self.torque += (contact.position - center).cross(force);
    }
}

impl<F: DistanceField + ?Sized, W: CountWork> Query<'_, F, W> {
    /// Penalty force and torque on the shell's body about `center`, all in the shell frame, for
    /// stiffness one. Points within the margin but outside of the solid add nothing.
    pub fn wrench(&self, center: Vec3, weight: Weight) -> Wrench {
        let mut wrench = Wrench::default();
        let areas = self.tree.areas();
        self.for_each_contact(|contact| {
            wrench.add(&contact, weight.of(areas[contact.point as usize]), center);
        });
        wrench
    }
}
