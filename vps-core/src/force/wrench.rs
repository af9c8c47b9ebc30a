//! Penalty force and torque.

use glamx::Vec3;
use wide::f32x4;

use crate::field::DistanceField;
use crate::query::contact::Contact;
use crate::query::posed::Query;
use crate::query::search::{Found, Goal};
use crate::query::work::CountWork;
use crate::shell::PointSphereTree;
use crate::simd::{Vectors, padded};

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
        let least = (-self.margin).max(0.0);
        self.find(Sum::new(self.tree, center, weight, least))
            .wrench()
    }
}

/// The wrench of all contacts, lane by lane.
pub(crate) struct Sum<'q> {
    least: f32,
    /// Of all points, if they count.
    areas: Option<&'q [f32]>,
    center: Vectors,
    force: Vectors,
    torque: Vectors,
}

impl<'q> Sum<'q> {
    /// Of points with at least so much penetration.
    pub(crate) fn new(
        tree: &'q PointSphereTree<'_>,
        center: Vec3,
        weight: Weight,
        least: f32,
    ) -> Self {
        Self {
            least,
            areas: (weight == Weight::Area).then(|| tree.areas()),
            center: Vectors::splat(center),
            force: Vectors::splat(Vec3::ZERO),
            torque: Vectors::splat(Vec3::ZERO),
        }
    }

    pub(crate) fn wrench(&self) -> Wrench {
        Wrench {
            force: self.force.sum(),
            torque: self.torque.sum(),
        }
    }

    /// A number of each point times what the point counts, zero for those that are no contacts.
    #[inline(always)]
    pub(crate) fn weighted(&self, found: &Found<'_>, numbers: f32x4) -> f32x4 {
        let numbers = found.counts & numbers;
        match self.areas {
            Some(areas) => {
                numbers * padded(&areas[found.first as usize..], |areas| f32x4::new(*areas))
            }
            None => numbers,
        }
    }

    /// Adds the forces of contacts along `directions`.
    #[inline(always)]
    pub(crate) fn push(&mut self, found: &Found<'_>, directions: Vectors) {
        let weights = self.weighted(found, found.penetrations.fast_max(f32x4::ZERO));
        let force = directions.times(weights);
        self.force = self.force.plus(force);
        self.torque = self.torque.plus(self.arms(found).cross(force));
    }

    /// From the point the torque is about.
    #[inline(always)]
    pub(crate) fn arms(&self, found: &Found<'_>) -> Vectors {
        found.positions.minus(self.center)
    }
}

impl Goal for Sum<'_> {
    const BEST_FIRST: bool = false;
    const ALL: bool = true;

    #[inline(always)]
    fn least_penetration(&self) -> f32 {
        self.least
    }

    #[inline(always)]
    fn offer(&mut self, found: &Found<'_>) -> bool {
        self.push(found, found.inward);
        true
    }
}
