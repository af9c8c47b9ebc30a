use core::ops::Mul;

use glamx::{Mat3, Quat, Vec3};
use wide::f32x4;

use crate::lanes::Vectors;
use crate::search::{Found, Goal};
use crate::work::CountWork;
use crate::wrench::Sum;
use crate::{DistanceField, Query, Weight, Wrench};

/// A penalty wrench, and how it changes when the shell's body moves: what an implicit integrator
/// needs to stay stable however stiff the contacts are.
///
/// Displaced by d and turned by the small rotation vector θ about the point the torque is about, a
/// contact is deeper by −(n·d + (r × n)·θ). So the force changes by −(`translational` d + `mixed`ᵀ θ)
/// and the torque by −(`mixed` d + `rotational` θ). The solid is taken as flat where it is touched,
/// and as facing the shell.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LinearWrench {
    /// Force and torque.
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
    /// [`wrench`](Self::wrench), and how it changes with the pose; all in the shell frame.
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

    #[inline(always)]
    fn least_penetration(&self) -> f32 {
        self.sum.least_penetration()
    }

    #[inline(always)]
    fn offer(&mut self, found: &Found<'_>) -> bool {
        let is_inside = found.penetrations.simd_gt(f32x4::ZERO);
        let weights = self.sum.weighted(found, is_inside & f32x4::ONE);
        let normals = found.inward;
        let moments = self.sum.arms(found).cross(normals);
        let (n, m) = (normals.times(weights), moments.times(weights));
        add_product(&mut self.translational, normals, n);
        add_product(&mut self.mixed, moments, n);
        add_product(&mut self.rotational, moments, m);
        self.sum.offer(found)
    }
}

/// Adds a bᵀ to a matrix of three columns.
#[inline(always)]
fn add_product(columns: &mut [Vectors; 3], a: Vectors, b: Vectors) {
    for (column, b) in columns.iter_mut().zip([b.x, b.y, b.z]) {
        *column = column.plus(a.times(b));
    }
}
