//! How two shapes move during a cast.

use rapier3d::math::{Pose, Real, Vector};
use rapier3d::parry::query::NonlinearRigidMotion;
use rapier3d::parry::shape::Shape;
use vps_core::Vec3;

use crate::precision::core_vector;

/// The velocity of a rigid body.
pub(crate) struct Twist {
    /// At the origin, in metres a second.
    linear: Vec3,
    /// In radians a second.
    angular: Vec3,
}

impl Twist {
    /// The velocity at a point, in metres a second.
    pub(crate) fn at(&self, point: Vec3) -> Vec3 {
        self.linear + self.angular.cross(point)
    }
}

/// How two shapes move.
pub(crate) trait Motion {
    /// The pose of the second shape in the frame of the first.
    fn pose12(&self, time: Real) -> Pose;

    /// The velocity of the second shape relative to the first, in the frame of the first.
    fn twist12(&self, time: Real) -> Twist;

    /// Upper bound of the speed at which two points of the shapes approach, in metres a second.
    fn closing_speed(&self) -> Real;
}

/// The second shape moves without turning.
pub(crate) struct Translation {
    pub(crate) start: Pose,
    pub(crate) velocity: Vector,
}

impl Motion for Translation {
    fn pose12(&self, time: Real) -> Pose {
        self.start.append_translation(self.velocity * time)
    }

    fn twist12(&self, _time: Real) -> Twist {
        Twist {
            linear: core_vector(self.velocity),
            angular: Vec3::ZERO,
        }
    }

    fn closing_speed(&self) -> Real {
        self.velocity.length()
    }
}

/// Both shapes move and turn in the world.
pub(crate) struct RigidMotions<'m> {
    motions: [&'m NonlinearRigidMotion; 2],
    closing_speed: Real,
}

impl<'m> RigidMotions<'m> {
    pub(crate) fn new(motions: [&'m NonlinearRigidMotion; 2], shapes: [&dyn Shape; 2]) -> Self {
        Self {
            motions,
            closing_speed: max_speed(motions[0], shapes[0]) + max_speed(motions[1], shapes[1]),
        }
    }
}

impl Motion for RigidMotions<'_> {
    fn pose12(&self, time: Real) -> Pose {
        let [pos1, pos2] = self.motions.map(|m| m.position_at_time(time));
        pos1.inv_mul(&pos2)
    }

    fn twist12(&self, time: Real) -> Twist {
        let pos1 = self.motions[0].position_at_time(time);
        let [velocity1, velocity2] = self.motions.map(|m| {
            let center = m.position_at_time(time) * m.local_center;
            m.linvel + m.angvel.cross(pos1.translation - center)
        });
        let spin = self.motions[1].angvel - self.motions[0].angvel;
        let to_first = pos1.rotation.inverse();
        Twist {
            linear: core_vector(to_first * (velocity2 - velocity1)),
            angular: core_vector(to_first * spin),
        }
    }

    fn closing_speed(&self) -> Real {
        self.closing_speed
    }
}

/// Upper bound of the speed of the points of a shape: that of its centre plus its angular speed times
/// its reach.
fn max_speed(motion: &NonlinearRigidMotion, shape: &dyn Shape) -> Real {
    let sphere = shape.compute_local_bounding_sphere();
    let reach = sphere.center.distance(motion.local_center) + sphere.radius;
    let spin = motion.angvel.length();
    let spin_speed = if spin == 0.0 { 0.0 } else { spin * reach };
    motion.linvel.length() + spin_speed
}
