//! The query dispatcher: which pairs are answered here, and which part by part of a compound.

use rapier3d::math::{Pose, Real, Vector};
use rapier3d::parry::query::details::{
    NormalConstraints, ShapeCastOptions, cast_shapes_composite_shape_shape,
    cast_shapes_nonlinear_composite_shape_shape, cast_shapes_nonlinear_shape_composite_shape,
    cast_shapes_shape_composite_shape, closest_points_composite_shape_shape,
    closest_points_shape_composite_shape, contact_composite_shape_shape,
    contact_shape_composite_shape, distance_composite_shape_shape, distance_shape_composite_shape,
    intersection_test_composite_shape_shape, intersection_test_shape_composite_shape,
};
use rapier3d::parry::query::{
    ClosestPoints, Contact as ParryContact, ContactManifold, ContactManifoldsWorkspace,
    DefaultQueryDispatcher, NonlinearRigidMotion, PersistentQueryDispatcher, QueryDispatcher,
    ShapeCastHit, ShapeDistance, ShapeIntersection, Unsupported,
};
use rapier3d::parry::shape::{Compound, Shape};
use vps_core::Observer;

use crate::compound::{as_compound_with_vps, update_parts};
use crate::manifolds::update_manifolds;
use crate::precision::{core_pose, core_real, real, vector};
use crate::query::cast::cast;
use crate::query::event::PairEvent;
use crate::query::motion::{RigidMotions, Translation};
use crate::query::pair::Pair;
use crate::query::pair_contact::PairContact;
use crate::query::shell_in_field::{ContactPoints, Sampling};
use crate::reduce::Manifolds;
use crate::warnings::set_connected;
use crate::workspace::mark;

/// Answers all queries about pairs with a [`VpsShape`](crate::VpsShape), also inside of a compound. All
/// other pairs are `Unsupported`: chain it with parry's own dispatcher.
///
/// It takes the place of Bullet's `btCollisionAlgorithm` (section 3.2).
#[derive(Clone, Copy, Debug, Default)]
pub struct VpsDispatcher {
    /// How voxelmaps are sampled.
    pub sampling: Sampling,
    /// Which point of the surface a contact has.
    pub contact_points: ContactPoints,
    /// Which contacts an engine gets.
    pub manifolds: Manifolds,
}

/// How two shapes are queried.
#[expect(
    clippy::large_enum_variant,
    reason = "one at a time, on the stack for one query"
)]
enum Task<'s> {
    Pair(Pair<'s>),
    /// Part by part of the first shape.
    PartsOfFirst(&'s Compound),
    /// Part by part of the second shape.
    PartsOfSecond(&'s Compound),
}

impl VpsDispatcher {
    fn task<'s>(&self, g1: &'s dyn Shape, g2: &'s dyn Shape) -> Result<Task<'s>, Unsupported> {
        set_connected();
        if let Some(compound) = as_compound_with_vps(g1) {
            return Ok(Task::PartsOfFirst(compound));
        }
        if let Some(compound) = as_compound_with_vps(g2) {
            return Ok(Task::PartsOfSecond(compound));
        }
        let pair = Pair::of(g1, g2, self.sampling, self.contact_points);
        pair.map(Task::Pair).ok_or(Unsupported)
    }

    /// The same as [`contact_manifolds`](PersistentQueryDispatcher::contact_manifolds) with an observer:
    /// why is a contact kept or dropped? The manifolds are the same. It takes longer, as every cluster
    /// and every point the query looks at is an event.
    ///
    /// `pos12` is the pose of the second shape in the frame of the first, `prediction` a distance in
    /// metres. The contacts of the step before are taken from `manifolds` and replaced.
    ///
    /// # Errors
    /// `Unsupported` if neither shape is a [`VpsShape`](crate::VpsShape), and for compounds, whose parts
    /// are pairs of their own.
    ///
    /// ```
    /// use std::cell::RefCell;
    /// use rapier3d::parry::query::ContactManifold;
    /// use rapier3d::prelude::*;
    /// use vps_rapier::{ContactEvent, PairEvent, VpsDispatcher, VpsShapeBuilder};
    ///
    /// let (vertices, triangles) = Cuboid::new(Vector::splat(0.5)).to_trimesh();
    /// let body = VpsShapeBuilder::from_triangles(&vertices, &triangles)?.build()?;
    /// let ground = Cuboid::new(Vector::new(5.0, 0.1, 5.0));
    /// let pose = Pose::from_translation(Vector::new(0.0, 0.599, 0.0));
    /// let kept = RefCell::new(Vec::new());
    /// let observer = |event| {
    ///     if let PairEvent::Contact { contact, event: ContactEvent::Kept, .. } = event {
    ///         kept.borrow_mut().push(contact);
    ///     }
    /// };
    /// let mut manifolds: Vec<ContactManifold<(), ()>> = Vec::new();
    /// let dispatcher = VpsDispatcher::default();
    /// dispatcher
    ///     .observe_contact_manifolds(&pose, &ground, &body, 0.01, &mut manifolds, &observer)
    ///     .unwrap();
    /// assert_eq!(kept.into_inner().len(), manifolds[0].points.len());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn observe_contact_manifolds<M: Default + Clone, C: Default + Copy>(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
        prediction: Real,
        manifolds: &mut Vec<ContactManifold<M, C>>,
        observer: &impl Observer<PairEvent>,
    ) -> Result<(), Unsupported> {
        let Task::Pair(pair) = self.task(g1, g2)? else {
            return Err(Unsupported);
        };
        update_manifolds(
            &pair,
            pos12,
            prediction,
            self.manifolds,
            manifolds,
            observer,
        );
        Ok(())
    }

    /// This dispatcher with parry's own for the other parts of compounds.
    fn with_parry(self) -> impl QueryDispatcher {
        self.chain(DefaultQueryDispatcher)
    }
}

impl QueryDispatcher for VpsDispatcher {
    fn intersection_test(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
    ) -> Result<ShapeIntersection, Unsupported> {
        let all = self.with_parry();
        Ok(match self.task(g1, g2)? {
            Task::Pair(pair) => pair.touches(&core_pose(pos12)).into(),
            Task::PartsOfFirst(parts) => {
                intersection_test_composite_shape_shape(&all, pos12, parts, g2)
            }
            Task::PartsOfSecond(parts) => {
                intersection_test_shape_composite_shape(&all, pos12, g1, parts)
            }
        })
    }

    fn distance(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
    ) -> Result<ShapeDistance, Unsupported> {
        let all = self.with_parry();
        Ok(match self.task(g1, g2)? {
            Task::Pair(pair) => {
                let closest = pair.closest(&core_pose(pos12), f32::INFINITY);
                closest.map_or(Real::INFINITY, |c| real((-c.penetration).max(0.0)))
            }
            .into(),
            Task::PartsOfFirst(parts) => distance_composite_shape_shape(&all, pos12, parts, g2),
            Task::PartsOfSecond(parts) => distance_shape_composite_shape(&all, pos12, g1, parts),
        })
    }

    fn contact(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
        prediction: Real,
    ) -> Result<Option<ParryContact>, Unsupported> {
        let all = self.with_parry();
        Ok(match self.task(g1, g2)? {
            Task::Pair(pair) => pair
                .closest(&core_pose(pos12), core_real(prediction))
                .map(PairContact::to_parry),
            Task::PartsOfFirst(parts) => {
                contact_composite_shape_shape(&all, pos12, parts, g2, prediction)
            }
            Task::PartsOfSecond(parts) => {
                contact_shape_composite_shape(&all, pos12, g1, parts, prediction)
            }
        })
    }

    fn closest_points(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
        max_dist: Real,
    ) -> Result<ClosestPoints, Unsupported> {
        let all = self.with_parry();
        Ok(match self.task(g1, g2)? {
            Task::Pair(pair) => match pair.closest(&core_pose(pos12), core_real(max_dist)) {
                Some(c) if c.penetration >= 0.0 => ClosestPoints::Intersecting,
                Some(c) => {
                    let [point1, point2] = c.points.map(vector);
                    ClosestPoints::WithinMargin(point1, point2)
                }
                None => ClosestPoints::Disjoint,
            },
            Task::PartsOfFirst(parts) => {
                closest_points_composite_shape_shape(&all, pos12, parts, g2, max_dist)
            }
            Task::PartsOfSecond(parts) => {
                closest_points_shape_composite_shape(&all, pos12, g1, parts, max_dist)
            }
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
        let all = self.with_parry();
        Ok(match self.task(g1, g2)? {
            Task::Pair(pair) => {
                let motion = Translation {
                    start: *pos12,
                    velocity: local_vel12,
                };
                cast(&pair, &motion, 0.0, options)
            }
            Task::PartsOfFirst(parts) => {
                cast_shapes_composite_shape_shape(&all, pos12, local_vel12, parts, g2, options)
            }
            Task::PartsOfSecond(parts) => {
                cast_shapes_shape_composite_shape(&all, pos12, local_vel12, g1, parts, options)
            }
        })
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
        let all = self.with_parry();
        let stop = stop_at_penetration;
        Ok(match self.task(g1, g2)? {
            Task::Pair(pair) => {
                let motion = RigidMotions::new([motion1, motion2], [g1, g2]);
                let options = ShapeCastOptions {
                    max_time_of_impact: end_time,
                    stop_at_penetration,
                    ..ShapeCastOptions::default()
                };
                cast(&pair, &motion, start_time, options)
            }
            Task::PartsOfFirst(parts) => cast_shapes_nonlinear_composite_shape_shape(
                &all, motion1, parts, motion2, g2, start_time, end_time, stop,
            ),
            Task::PartsOfSecond(parts) => cast_shapes_nonlinear_shape_composite_shape(
                &all, motion1, g1, motion2, parts, start_time, end_time, stop,
            ),
        })
    }
}

impl<M, C> PersistentQueryDispatcher<M, C> for VpsDispatcher
where
    M: Default + Clone + Send + Sync,
    C: Default + Copy + Send + Sync,
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
        match self.task(g1, g2)? {
            Task::Pair(pair) => {
                update_manifolds(&pair, pos12, prediction, self.manifolds, manifolds, &());
            }
            Task::PartsOfFirst(_) | Task::PartsOfSecond(_) => {
                let all = self.chain(DefaultQueryDispatcher);
                update_parts(&all, pos12, [g1, g2], prediction, manifolds);
            }
        }
        mark(workspace);
        Ok(())
    }

    /// VPS shapes are not convex, so this is never asked about them.
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
