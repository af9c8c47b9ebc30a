use rapier3d::math::{Pose, Real, Vector};
use rapier3d::parry::query::details::{NormalConstraints, ShapeCastOptions};
use rapier3d::parry::query::{
    ClosestPoints, Contact as ParryContact, ContactManifold, ContactManifoldsWorkspace,
    NonlinearRigidMotion, PersistentQueryDispatcher, QueryDispatcher, ShapeCastHit,
    ShapeCastStatus, ShapeDistance, ShapeIntersection, Unsupported,
};
use rapier3d::parry::shape::Shape;

use crate::contacts::{SurfaceContact, update_manifolds};
use crate::pair::{Pair, Sampling};

/// Answers all queries about pairs with a [`VpsShape`](crate::VpsShape), and says `Unsupported` to
/// all others: chain it with parry's own dispatcher.
///
/// This is where Bullet's `btCollisionAlgorithm` was (section 3.2).
#[derive(Clone, Copy, Debug, Default)]
pub struct VpsDispatcher {
    /// How voxelmaps are sampled.
    pub sampling: Sampling,
}

/// Advances of a shape cast before it gives up.
const CAST_STEPS: usize = 64;

impl VpsDispatcher {
    fn pair<'s>(&self, g1: &'s dyn Shape, g2: &'s dyn Shape) -> Result<Pair<'s>, Unsupported> {
        Pair::of(g1, g2, self.sampling).ok_or(Unsupported)
    }
}

/// The closest points of the two shapes, or the deepest ones.
fn closest(pair: &Pair<'_>, pos12: &Pose, within: Real) -> Option<ParryContact> {
    let contact = pair.deepest(pos12, within)?;
    let surface = SurfaceContact::new(pair, &pair.shell_to_field(pos12), &contact);
    let (point1, point2) = pair.in_order(surface.on_shell, surface.on_field);
    let (normal1, normal2) = pair.in_order(surface.shell_normal, surface.field_normal);
    Some(ParryContact::new(
        point1,
        point2,
        normal1,
        normal2,
        -contact.penetration,
    ))
}

impl QueryDispatcher for VpsDispatcher {
    fn intersection_test(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
    ) -> Result<ShapeIntersection, Unsupported> {
        Ok(self.pair(g1, g2)?.touches(pos12).into())
    }

    fn distance(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
    ) -> Result<ShapeDistance, Unsupported> {
        let pair = self.pair(g1, g2)?;
        let closest = closest(&pair, pos12, Real::INFINITY);
        Ok(closest.map_or(Real::INFINITY, |c| c.dist.max(0.0)).into())
    }

    fn contact(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
        prediction: Real,
    ) -> Result<Option<ParryContact>, Unsupported> {
        Ok(closest(&self.pair(g1, g2)?, pos12, prediction))
    }

    fn closest_points(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
        max_dist: Real,
    ) -> Result<ClosestPoints, Unsupported> {
        Ok(match closest(&self.pair(g1, g2)?, pos12, max_dist) {
            Some(c) if c.dist <= 0.0 => ClosestPoints::Intersecting,
            Some(c) => ClosestPoints::WithinMargin(c.point1, c.point2),
            None => ClosestPoints::Disjoint,
        })
    }

    fn cast_shapes(
        &self,
        pos12: &Pose,
        local_vel12: Vector,
        g1: &dyn Shape,
        g2: &dyn Shape,
        options: ShapeCastOptions,
    ) -> Result<Option<ShapeCastHit>, Unsupported> {
        let pair = self.pair(g1, g2)?;
        let pose_at = |time| pos12.append_translation(local_vel12 * time);
        Ok(cast(&pair, pose_at, local_vel12.length(), 0.0, options))
    }

    fn cast_shapes_nonlinear(
        &self,
        motion1: &NonlinearRigidMotion,
        g1: &dyn Shape,
        motion2: &NonlinearRigidMotion,
        g2: &dyn Shape,
        start_time: Real,
        end_time: Real,
        stop_at_penetration: bool,
    ) -> Result<Option<ShapeCastHit>, Unsupported> {
        let pair = self.pair(g1, g2)?;
        let pose_at = |time| {
            let [pos1, pos2] = [motion1, motion2].map(|m| m.position_at_time(time));
            pos1.inv_mul(&pos2)
        };
        // No point of a shape is faster than its centre plus its spin times its reach.
        let speed = |motion: &NonlinearRigidMotion, g: &dyn Shape| {
            let sphere = g.compute_local_bounding_sphere();
            let reach = sphere.center.distance(motion.local_center) + sphere.radius;
            let spin = motion.angvel.length();
            let spin_speed = if spin == 0.0 { 0.0 } else { spin * reach };
            motion.linvel.length() + spin_speed
        };
        let closing_speed = speed(motion1, g1) + speed(motion2, g2);
        let options = ShapeCastOptions {
            max_time_of_impact: end_time,
            stop_at_penetration,
            ..ShapeCastOptions::default()
        };
        Ok(cast(&pair, pose_at, closing_speed, start_time, options))
    }
}

/// Conservative advancement: as long as the shapes are apart, neither can meet the other sooner
/// than their distance divided by their closing speed. From afar the lower bound of the distance
/// is taken, since distances of a voxelmap may be too large there; close by, where that bound is
/// mostly its own error, half of the distance.
fn cast(
    pair: &Pair<'_>,
    pose_at: impl Fn(Real) -> Pose,
    closing_speed: Real,
    start_time: Real,
    options: ShapeCastOptions,
) -> Option<ShapeCastHit> {
    let near = 4.0 * pair.resolution();
    let tolerance = 1e-4 * pair.tree.bounds().extents().length();
    let mut time = start_time;
    let mut status = ShapeCastStatus::OutOfIterations;
    let mut closest_now = closest(pair, &pose_at(time), Real::INFINITY)?;
    if closest_now.dist <= options.target_distance {
        if !options.stop_at_penetration {
            return None;
        }
        status = ShapeCastStatus::PenetratingOrWithinTargetDist;
    } else {
        for _ in 0..CAST_STEPS {
            let free = closest_now.dist - options.target_distance;
            if free <= tolerance {
                status = ShapeCastStatus::Converged;
                break;
            }
            let sure = pair.clearance(&pose_at(time)) - options.target_distance;
            time += sure.max(0.5 * free.min(near)) / closing_speed;
            // Also when nothing moves.
            let in_time = time <= options.max_time_of_impact;
            if !in_time {
                return None;
            }
            closest_now = closest(pair, &pose_at(time), Real::INFINITY)?;
        }
    }
    Some(ShapeCastHit {
        time_of_impact: time,
        witness1: closest_now.point1,
        witness2: closest_now.point2,
        normal1: closest_now.normal1,
        normal2: closest_now.normal2,
        status,
        subshape1: 0,
        subshape2: 0,
    })
}

impl<M, C> PersistentQueryDispatcher<M, C> for VpsDispatcher
where
    M: Default + Clone,
    C: Default + Copy,
{
    fn contact_manifolds(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
        prediction: Real,
        manifolds: &mut Vec<ContactManifold<M, C>>,
        workspace: &mut Option<ContactManifoldsWorkspace>,
    ) -> Result<(), Unsupported> {
        let pair = self.pair(g1, g2)?;
        update_manifolds(&pair, pos12, prediction, manifolds, workspace);
        Ok(())
    }

    /// VPS shapes are not convex, so this is never about them.
    fn contact_manifold_convex_convex(
        &self,
        _pos12: &Pose,
        _g1: &dyn Shape,
        _g2: &dyn Shape,
        _normal_constraints1: Option<&dyn NormalConstraints>,
        _normal_constraints2: Option<&dyn NormalConstraints>,
        _prediction: Real,
        _manifold: &mut ContactManifold<M, C>,
    ) -> Result<(), Unsupported> {
        Err(Unsupported)
    }
}
