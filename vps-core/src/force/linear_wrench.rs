//! Force and torque with their derivative by the pose.

use core::ops::Mul;

use glamx::{Mat3, Quat, Vec3};
use wide::f32x4;

use crate::field::DistanceField;
use crate::force::wrench::{Weight, Wrench, WrenchSum};
use crate::query::collectors::{Collector, TestedPoints};
use crate::query::observer::Observer;
use crate::query::posed::Query;
use crate::simd::Vectors;

/// The wrench of a potential with its derivative by the pose of the shell's body. An implicit
/// integrator needs both to stay stable with contacts of any stiffness.
///
/// A contact stores the energy w V² / 2 for stiffness one, w being its [`Weight`]. With
/// n = −∇V, the outward gradient of the field at the contact, it exerts the force w V n. After a
/// displacement d and a small rotation θ (a vector) about the reference point of the torque, it is
/// deeper by −(n·d + (r × n)·θ). So the force changes by −(`translational` d + `mixed`ᵀ θ) and the
/// torque by −(`mixed` d + `rotational` θ). This is the derivative by the pose for a field without
/// curvature at the contact. The curvature term, which turns forces but stores no energy, is left out.
///
/// The normals of the shell are not used. Where they are tilted, as at sharp edges, forces along them
/// would not derive from a potential, and their stiffness would hinder sliding.
///
/// ```
/// use vps_core::{HalfSpace, PointSphereTree, Pose3, Query, Vec3, Weight};
///
/// // The ends of a peg that stands on the ground, one of them 10 mm too deep.
/// let (low, high) = (Vec3::new(0.0, -0.01, 0.0), Vec3::new(0.0, 0.2, 0.0));
/// let tree = PointSphereTree::flat(&[low, high], &[Vec3::Y, Vec3::NEG_Y], 1e-4)?;
/// let ground = HalfSpace::new(Vec3::Y);
/// let query = Query::new(&tree, &ground, Pose3::IDENTITY);
/// let contact = query.linear_wrench(Vec3::ZERO, Weight::Area) * 1e9; // N/m³
/// assert!((contact.wrench.force.y - 1e3).abs() < 1e-2);
/// assert!((contact.translational.y_axis.y - 1e5).abs() < 1.0); // N/m
/// # Ok::<(), vps_core::TreeError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LinearWrench {
    /// Force and torque: minus the derivative of the potential.
    pub wrench: Wrench,
    /// Sum of w n nᵀ over the contacts: N/m once multiplied by a stiffness.
    pub translational: Mat3,
    /// Sum of w (r × n) nᵀ: N.
    pub mixed: Mat3,
    /// Sum of w (r × n)(r × n)ᵀ: N m.
    pub rotational: Mat3,
}

impl LinearWrench {
    /// No force, and no stiffness.
    pub const ZERO: Self = Self {
        wrench: Wrench {
            force: Vec3::ZERO,
            torque: Vec3::ZERO,
        },
        translational: Mat3::ZERO,
        mixed: Mat3::ZERO,
        rotational: Mat3::ZERO,
    };

    /// The same wrench in another frame; `rotation` transforms vectors to that frame.
    pub fn rotated(&self, rotation: Quat) -> Self {
        let to = Mat3::from_quat(rotation);
        let rotated_matrix = |matrix| to * matrix * to.transpose();
        Self {
            wrench: Wrench {
                force: rotation * self.wrench.force,
                torque: rotation * self.wrench.torque,
            },
            translational: rotated_matrix(self.translational),
            mixed: rotated_matrix(self.mixed),
            rotational: rotated_matrix(self.rotational),
        }
    }

    pub(crate) fn is_finite(&self) -> bool {
        self.wrench.force.is_finite()
            && self.wrench.torque.is_finite()
            && [self.translational, self.mixed, self.rotational]
                .iter()
                .all(Mat3::is_finite)
    }
}

/// A wrench that does not change with the pose.
impl From<Wrench> for LinearWrench {
    fn from(wrench: Wrench) -> Self {
        Self {
            wrench,
            ..Self::ZERO
        }
    }
}

/// Scaling by a stiffness.
impl Mul<f32> for LinearWrench {
    type Output = Self;

    fn mul(self, stiffness: f32) -> Self {
        Self {
            wrench: Wrench {
                force: self.wrench.force * stiffness,
                torque: self.wrench.torque * stiffness,
            },
            translational: self.translational * stiffness,
            mixed: self.mixed * stiffness,
            rotational: self.rotational * stiffness,
        }
    }
}

impl<F: DistanceField + ?Sized, O: Observer> Query<'_, F, O> {
    /// Force along the gradient of the field and torque about `center` on the shell's body, with
    /// their derivative by the pose; all in the shell frame, for stiffness one. Where the shell's
    /// normals equal those of the field, the force equals that of [`wrench`](Self::wrench).
    pub fn linear_wrench(&self, center: Vec3, weight: Weight) -> LinearWrench {
        let penetration_threshold = (-self.prediction).max(0.0);
        let none = [Vectors::splat(Vec3::ZERO); 3];
        let found = self.collect(LinearWrenchSum {
            sum: WrenchSum::new(self.tree, center, weight, penetration_threshold),
            translational: none,
            mixed: none,
            rotational: none,
        });
        let matrix = |columns: [Vectors; 3]| {
            let [x, y, z] = columns.map(Vectors::sum);
            Mat3::from_cols(x, y, z)
        };
        LinearWrench {
            wrench: found.sum.wrench(),
            translational: matrix(found.translational),
            mixed: matrix(found.mixed),
            rotational: matrix(found.rotational),
        }
    }
}

/// Sums up the wrench of all contacts and the columns of its matrices, lane by lane.
struct LinearWrenchSum<'q> {
    sum: WrenchSum<'q>,
    translational: [Vectors; 3],
    mixed: [Vectors; 3],
    rotational: [Vectors; 3],
}

impl Collector for LinearWrenchSum<'_> {
    const BEST_FIRST: bool = false;
    const COLLECTS_ALL: bool = true;
    const NEEDS_GRADIENT: bool = true;

    #[inline(always)]
    fn penetration_threshold(&self) -> f32 {
        self.sum.penetration_threshold()
    }

    #[inline(always)]
    fn add(&mut self, found: &TestedPoints<'_>) -> bool {
        let is_inside = found.penetrations.simd_gt(f32x4::ZERO);
        let weights = self.sum.weighted(found, is_inside & f32x4::ONE);
        let normals = found.outward;
        let moments = self.sum.lever_arms(found).cross(normals);
        let (n, m) = (normals.times(weights), moments.times(weights));
        add_product(&mut self.translational, normals, n);
        add_product(&mut self.mixed, moments, n);
        add_product(&mut self.rotational, moments, m);
        self.sum.add_forces(found, normals);
        true
    }
}

/// Adds a bᵀ to a matrix of three columns.
#[inline(always)]
fn add_product(columns: &mut [Vectors; 3], a: Vectors, b: Vectors) {
    for (column, b) in columns.iter_mut().zip([b.x, b.y, b.z]) {
        *column = column.plus(a.times(b));
    }
}
