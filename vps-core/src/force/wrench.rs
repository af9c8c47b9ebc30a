//! Penalty force and torque.

use glamx::Vec3;
use wide::f32x4;

use crate::field::DistanceField;
use crate::query::collectors::{Collector, TestedPoints};
use crate::query::contact::Contact;
use crate::query::observer::Observer;
use crate::query::posed::Query;
use crate::shell::PointSphereTree;
use crate::simd::{Vectors, padded};

/// The penalty force and torque of a contact set (eqs. 2 and 3), for stiffness one.
///
/// ```
/// use vps_core::{HalfSpace, PointSphereTree, Pose3, Query, Vec3, Weight};
///
/// // The ends of a peg that stands on the ground, one of them 10 mm too deep.
/// let (low, high) = (Vec3::new(0.0, -0.01, 0.0), Vec3::new(0.0, 0.2, 0.0));
/// let tree = PointSphereTree::flat(&[low, high], &[Vec3::Y, Vec3::NEG_Y], 1e-4)?;
/// let ground = HalfSpace::new(Vec3::Y);
/// let query = Query::new(&tree, &ground, Pose3::IDENTITY);
/// let stiffness = 1e9; // N/m³
/// let force = query.wrench(Vec3::ZERO, Weight::Area).force * stiffness;
/// assert!((force - Vec3::Y * 1e3).length() < 1e-2);
/// # Ok::<(), vps_core::TreeError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wrench {
    /// Sum of wVn over the contacts: newtons once multiplied by a stiffness.
    pub force: Vec3,
    /// Sum of r × wVn, r being the lever arm from the reference point: newton metres once multiplied
    /// by a stiffness.
    pub torque: Vec3,
}

/// The weight of each contact in a [`Wrench`].
///
/// ```
/// use vps_core::{HalfSpace, PointSphereTree, Pose3, Query, Vec3, Weight};
///
/// // The ends of a peg that stands on the ground, one of them 10 mm too deep.
/// let (low, high) = (Vec3::new(0.0, -0.01, 0.0), Vec3::new(0.0, 0.2, 0.0));
/// let tree = PointSphereTree::flat(&[low, high], &[Vec3::Y, Vec3::NEG_Y], 1e-4)?;
/// let ground = HalfSpace::new(Vec3::Y);
/// let query = Query::new(&tree, &ground, Pose3::IDENTITY);
/// let force = |weight| query.wrench(Vec3::ZERO, weight).force.y;
/// assert!((force(Weight::Point) - 0.01).abs() < 1e-7);
/// assert!((force(Weight::Area) - 0.01 * 1e-4).abs() < 1e-11);
/// # Ok::<(), vps_core::TreeError>(())
/// ```
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
    /// Adds the force of a contact on the shell's body and its torque about `center`, in the shell
    /// frame. A contact outside of the solid exerts none.
    #[inline]
    pub(crate) fn add(&mut self, contact: &Contact, weight: f32, center: Vec3) {
        let force = weight * contact.penetration.max(0.0) * contact.normal;
        self.force += force;
        self.torque += (contact.position - center).cross(force);
    }
}

impl<F: DistanceField + ?Sized, O: Observer> Query<'_, F, O> {
    /// Penalty force and torque on the shell's body about `center`, all in the shell frame, for
    /// stiffness one. Points within the prediction distance but outside of the solid add nothing.
    pub fn wrench(&self, center: Vec3, weight: Weight) -> Wrench {
        let penetration_threshold = (-self.prediction).max(0.0);
        self.collect(WrenchSum::new(
            self.tree,
            center,
            weight,
            penetration_threshold,
        ))
        .wrench()
    }
}

/// Sums up the wrench of all contacts, lane by lane.
pub(crate) struct WrenchSum<'q> {
    penetration_threshold: f32,
    /// The areas of all points, with [`Weight::Area`].
    areas: Option<&'q [f32]>,
    center: Vectors,
    force: Vectors,
    torque: Vectors,
}

impl<'q> WrenchSum<'q> {
    /// The sum over the points with at least that penetration.
    pub(crate) fn new(
        tree: &'q PointSphereTree<'_>,
        center: Vec3,
        weight: Weight,
        penetration_threshold: f32,
    ) -> Self {
        Self {
            penetration_threshold,
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

    /// Each number times the weight of its point, zero for points that are not in contact.
    #[inline(always)]
    pub(crate) fn weighted(&self, found: &TestedPoints<'_>, numbers: f32x4) -> f32x4 {
        let numbers = found.contact_mask & numbers;
        match self.areas {
            Some(areas) => {
                numbers * padded(&areas[found.first as usize..], |areas| f32x4::new(*areas))
            }
            None => numbers,
        }
    }

    /// Adds the forces of contacts along `directions`.
    #[inline(always)]
    pub(crate) fn add_forces(&mut self, found: &TestedPoints<'_>, directions: Vectors) {
        let weights = self.weighted(found, found.penetrations.fast_max(f32x4::ZERO));
        let force = directions.times(weights);
        self.force = self.force.plus(force);
        self.torque = self.torque.plus(self.lever_arms(found).cross(force));
    }

    /// Lever arms from the reference point of the torque.
    #[inline(always)]
    pub(crate) fn lever_arms(&self, found: &TestedPoints<'_>) -> Vectors {
        found.positions.minus(self.center)
    }
}

impl Collector for WrenchSum<'_> {
    const BEST_FIRST: bool = false;
    const COLLECTS_ALL: bool = true;

    #[inline(always)]
    fn penetration_threshold(&self) -> f32 {
        self.penetration_threshold
    }

    #[inline(always)]
    fn add(&mut self, found: &TestedPoints<'_>) -> bool {
        self.add_forces(found, found.inward);
        true
    }
}
