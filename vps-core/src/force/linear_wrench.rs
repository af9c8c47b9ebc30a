//! Force and torque with their derivative by the pose.

use core::ops::Mul;

use glamx::{Mat3, Quat, Vec3};
use wide::f32x4;

use crate::field::DistanceField;
use crate::force::wrench::{Sum, Weight, Wrench};
use crate::query::posed::Query;
use crate::query::search::{Found, Goal};
use crate::query::work::CountWork;
use crate::simd::Vectors;

/// The wrench of a potential, and how it changes when the shell's body moves: what an implicit
/// integrator needs to stay stable however stiff the contacts are.
///
/// A contact stores the energy w V² / 2 for stiffness one, w being its [`Weight`]. With
/// n = −∇V, the way out of the solid as the field has it at the contact, it exerts the force w V n.
/// Displaced by d and turned by the small rotation vector θ about the point the torque is about, it is
/// deeper by −(n·d + (r × n)·θ). So the force changes by −(`translational` d + `mixed`ᵀ θ) and the
/// torque by −(`mixed` d + `rotational` θ): the derivative by the pose of a field that is flat where
/// it is touched. Left out is what its curvature adds, which turns forces but stores nothing.
///
/// The normals of the shell are not in it. Where they are tilted, as at sharp edges, forces along
/// them would belong to no potential, and their stiffness would hold back what slides.
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

    /// The same in the frame that `rotation` takes its vectors to.
    pub fn rotated(&self, rotation: Quat) -> Self {
        let to = Mat3::from_quat(rotation);
        let turned = |matrix| to * matrix * to.transpose();
        Self {
            wrench: Wrench {
                force: rotation * self.wrench.force,
                torque: rotation * self.wrench.torque,
            },
            translational: turned(self.translational),
            mixed: turned(self.mixed),
            rotational: turned(self.rotational),
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

/// Of one that does not change with the pose.
impl From<Wrench> for LinearWrench {
    fn from(wrench: Wrench) -> Self {
        Self {
            wrench,
            ..Self::ZERO
        }
    }
}

/// For a stiffness other than one.
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

impl<F: DistanceField + ?Sized, W: CountWork> Query<'_, F, W> {
    /// Force and torque on the shell's body about `center` along the gradient of the field, and how
    /// they change with the pose; all in the shell frame, for stiffness one. Where the shell's
    /// normals are those of the field, the force is that of [`wrench`](Self::wrench).
    pub fn linear_wrench(&self, center: Vec3, weight: Weight) -> LinearWrench {
        let least = (-self.margin).max(0.0);
        let none = [Vectors::splat(Vec3::ZERO); 3];
        let found = self.find(Linear {
            sum: Sum::new(self.tree, center, weight, least),
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

/// The wrench of all contacts and the columns of its matrices, lane by lane.
struct Linear<'q> {
    sum: Sum<'q>,
    translational: [Vectors; 3],
    mixed: [Vectors; 3],
    rotational: [Vectors; 3],
}

impl Goal for Linear<'_> {
    const BEST_FIRST: bool = false;
    const ALL: bool = true;
    const WAY_OUT: bool = true;

    #[inline(always)]
    fn least_penetration(&self) -> f32 {
        self.sum.least_penetration()
    }

    #[inline(always)]
    fn offer(&mut self, found: &Found<'_>) -> bool {
        let is_inside = found.penetrations.simd_gt(f32x4::ZERO);
        let weights = self.sum.weighted(found, is_inside & f32x4::ONE);
        let normals = found.way_out;
        let moments = self.sum.arms(found).cross(normals);
        let (n, m) = (normals.times(weights), moments.times(weights));
        add_product(&mut self.translational, normals, n);
        add_product(&mut self.mixed, moments, n);
        add_product(&mut self.rotational, moments, m);
        self.sum.push(found, normals);
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
