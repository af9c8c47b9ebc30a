//! One of the two ways to look at a pair: a shell in a field.

use std::cell::RefCell;
use std::rc::Rc;

use rapier3d::parry::shape::{FeatureId, PackedFeatureId, Shape, TypedShape};
use vps_core::{
    Ball, Contact, ContactManifold, Cuboid, DistanceField, HalfSpace, LocalPenetration,
    PointSphereTree, Pose3, Query, Trilinear, Vec3, Weight,
};

use crate::contact::PairContact;
use crate::real::{core_real, core_vector};
use crate::shape_field::{error_of, moved};
use crate::surroundings::Surroundings;
use crate::{Sampling, ShapeField, VpsShape};

/// Most contacts of a pair in both directions of looking at it.
pub(crate) const SPREAD_SIZE: usize = 8;

/// A pointshell in a field.
pub(crate) struct Way<'s> {
    tree: &'s PointSphereTree<'static>,
    field: Field<'s>,
    /// The VPS shape the field is of.
    of_shape: Option<&'s VpsShape>,
    /// What the error of the field may be more far from the surface, in metres.
    far_error: f32,
    /// Whether the first of the two shapes is the shell.
    shell_is_first: bool,
}

enum Field<'s> {
    Trilinear(Trilinear<'s>),
    Local(LocalPenetration<'s>),
    Ball(Ball),
    Cuboid(Cuboid),
    HalfSpace(HalfSpace),
    Other(Nearby<'s>),
}

/// A shape of parry, of which only what is near the shell is looked at.
struct Nearby<'s> {
    shape: &'s dyn Shape,
    thickness: f32,
    picked: RefCell<Option<Rc<Picked<'s>>>>,
}

/// What of a shape is within `reach` metres of the shell in a pose.
struct Picked<'s> {
    pose: Pose3,
    reach: f32,
    field: ShapeField<'s>,
}

impl<'s> Nearby<'s> {
    /// Calls `ask` with the field of what matters to a query up to `margin` metres away.
    fn with_field<T>(
        &self,
        tree: &PointSphereTree<'_>,
        pose: &Pose3,
        margin: f32,
        ask: impl FnOnce(&ShapeField<'s>) -> T,
    ) -> T {
        let reach = margin.max(self.thickness);
        let before = self.picked.borrow().clone();
        let before = before.filter(|p| p.pose == *pose && p.reach >= reach);
        let picked = before.unwrap_or_else(|| {
            let around = moved(&tree.bounds(), pose);
            let field = ShapeField::near(self.shape, self.thickness, around, reach);
            let picked = Rc::new(Picked {
                pose: *pose,
                reach,
                field,
            });
            self.picked.replace(Some(picked.clone()));
            picked
        });
        ask(&picked.field)
    }

    /// Whether all of the shape was picked for the query before.
    fn holds_all(&self) -> bool {
        let picked = self.picked.borrow();
        picked.as_ref().is_some_and(|p| p.field.is_all())
    }
}

/// Evaluates an expression with the field of a way as a variable of its own type, so that a query
/// is compiled for each kind of field and decides nothing a point. It is the field around the shell in
/// a pose, as far as something up to `margin` metres away needs it.
macro_rules! with_field {
    ($way:expr, $pose:expr, $margin:expr, $field:ident => $body:expr) => {
        match &$way.field {
            Field::Trilinear($field) => $body,
            Field::Local($field) => $body,
            Field::Ball($field) => $body,
            Field::Cuboid($field) => $body,
            Field::HalfSpace($field) => $body,
            Field::Other(nearby) => nearby.with_field($way.tree, $pose, $margin, |$field| $body),
        }
    };
}

impl<'s> Way<'s> {
    /// The shell of one VPS shape in the voxelmap of another.
    pub(crate) fn in_map(
        shell: &'s VpsShape,
        field: &'s VpsShape,
        sampling: Sampling,
        shell_is_first: bool,
    ) -> Self {
        let map = &field.asset().voxelmap;
        Self {
            tree: &shell.asset().tree,
            field: match sampling {
                Sampling::Trilinear => Field::Trilinear(map.trilinear()),
                Sampling::Local => Field::Local(map.local()),
            },
            of_shape: Some(field),
            far_error: map.accuracy().far_m,
            shell_is_first,
        }
    }

    /// The shell of a VPS shape in a shape of parry.
    pub(crate) fn in_shape(
        shell: &'s VpsShape,
        shape: &'s dyn Shape,
        shell_is_first: bool,
    ) -> Self {
        // An open surface holds a body that is through it by up to a tenth of its size.
        let thickness = 0.1 * shell.asset().tree.bounds().extents().length();
        let field = match shape.as_typed_shape() {
            TypedShape::Ball(ball) => Field::Ball(Ball::new(core_real(ball.radius))),
            TypedShape::Cuboid(cuboid) => {
                Field::Cuboid(Cuboid::new(core_vector(cuboid.half_extents)))
            }
            TypedShape::HalfSpace(half_space) => {
                Field::HalfSpace(HalfSpace::new(core_vector(half_space.normal)))
            }
            _ => Field::Other(Nearby {
                shape,
                thickness,
                picked: RefCell::new(None),
            }),
        };
        Self {
            tree: &shell.asset().tree,
            field,
            of_shape: None,
            far_error: 0.0,
            shell_is_first,
        }
    }

    /// Whether the shell as a whole may lie in the solid of a VPS shape, going by the boxes.
    pub(crate) fn may_be_within(&self, pos12: &Pose3) -> bool {
        let Some(shape) = self.of_shape else {
            return false;
        };
        let solid = shape.asset().voxelmap.solid();
        solid.may_hold(&self.tree.bounds(), &self.shell_to_field(pos12))
    }

    /// Whether the shell touches the solid, `pos12` being the pose of the second shape in the frame
    /// of the first.
    pub(crate) fn touches(&self, pos12: &Pose3) -> bool {
        let pose = self.shell_to_field(pos12);
        with_field!(self, &pose, 0.0, field => Query::new(self.tree, field, pose).touches())
    }

    /// The deepest contact up to `margin` metres away.
    pub(crate) fn deepest(&self, pos12: &Pose3, margin: f32) -> Option<PairContact> {
        let pose = self.shell_to_field(pos12);
        let (mut within, other) = match &self.field {
            // What is far away is looked at if nothing is near.
            Field::Other(nearby) => (margin.min(self.size()), Some(nearby)),
            _ => (margin, None),
        };
        loop {
            let found = with_field!(self, &pose, within, field => {
                Query::new(self.tree, field, pose).with_margin(within).deepest()
            });
            if let Some(contact) = found {
                return Some(self.on_surfaces(&pose, &contact, within));
            }
            if within >= margin {
                return None;
            }
            within = match other {
                Some(nearby) if !nearby.holds_all() => margin.min(4.0 * within),
                _ => margin,
            };
        }
    }

    /// The normal out of the first shape that all contacts up to `margin` metres away have, if there is
    /// one.
    pub(crate) fn level_normal(&self, pos12: &Pose3, margin: f32) -> Option<Vec3> {
        let pose = self.shell_to_field(pos12);
        let inward = match &self.field {
            Field::HalfSpace(field) => Some(field.inward_direction(Vec3::ZERO)),
            Field::Other(nearby) => {
                nearby.with_field(self.tree, &pose, margin, ShapeField::level_direction)
            }
            _ => None,
        };
        inward.map(|inward| {
            if self.shell_is_first {
                pose.rotation.inverse() * inward
            } else {
                -inward
            }
        })
    }

    /// The deepest contact up to `margin` metres away, at its distance also from outside of the grid
    /// of a map, where the field has a lower bound alone.
    pub(crate) fn closest(&self, pos12: &Pose3, margin: f32) -> Option<PairContact> {
        let found = self.deepest(pos12, margin)?;
        let Some(shape) = self.of_shape else {
            return Some(found);
        };
        let pose = self.shell_to_field(pos12);
        let of_shell = if self.shell_is_first { 0 } else { 1 };
        if shape.has_in_grid(pose.transform_point(found.points[of_shell])) {
            return Some(found);
        }
        let contact = Query::new(self.tree, &Surroundings::new(shape), pose).closest()?;
        let in_field = pose.transform_point(contact.position);
        if shape.has_in_grid(in_field) {
            return Some(self.on_surfaces(&pose, &contact, margin));
        }
        let on_field = shape.closest_on_surface(in_field);
        let inward = (on_field - in_field).normalize_or_zero();
        let penetration = -on_field.distance(in_field);
        let exact = Contact {
            penetration,
            ..contact
        };
        (penetration >= -margin).then(|| self.between(&pose, &exact, inward))
    }

    /// How far the shell may move, in metres, and meet nothing but one plane; 0 if that is not known.
    pub(crate) fn level_reach(&self, pos12: &Pose3) -> f32 {
        match (&self.field, self.level_normal(pos12, 0.0)) {
            (Field::HalfSpace(_), _) => f32::INFINITY,
            (Field::Other(nearby), Some(_)) => nearby.thickness,
            _ => 0.0,
        }
    }

    /// The deepest of all contacts up to `margin` metres away of which something is true. Of a point
    /// of the shell and its normal out of the first shape, both in the frame of the first, `is_worth`
    /// says at less cost whether that may be.
    pub(crate) fn deepest_of(
        &self,
        pos12: &Pose3,
        margin: f32,
        is_worth: &dyn Fn(Vec3, Vec3) -> bool,
        is_wanted: &dyn Fn(&PairContact) -> bool,
    ) -> Option<PairContact> {
        let pose = self.shell_to_field(pos12);
        let mut deepest: Option<PairContact> = None;
        let visit = |contact: Contact| {
            if deepest.is_some_and(|d| d.penetration >= contact.penetration) {
                return;
            }
            let (point, out) = if self.shell_is_first {
                (contact.position, -contact.normal)
            } else {
                let out = pos12.rotation * contact.normal;
                (pos12.transform_point(contact.position), out)
            };
            if !is_worth(point, out) {
                return;
            }
            let contact = self.on_surfaces(&pose, &contact, margin);
            if is_wanted(&contact) {
                deepest = Some(contact);
            }
        };
        with_field!(self, &pose, margin, field => {
            Query::new(self.tree, field, pose).with_margin(margin).for_each_contact(visit);
        });
        deepest
    }

    /// The deepest contact first, then those that spread over the largest area; found faster if the
    /// first of the step before is deep still.
    pub(crate) fn manifold(
        &self,
        pos12: &Pose3,
        margin: f32,
        motion: Option<f32>,
        before: &[[PackedFeatureId; 2]],
        found: &mut Vec<PairContact>,
    ) {
        let pose = self.shell_to_field(pos12);
        let hint = before.first().and_then(|ids| {
            let of_shell = if self.shell_is_first { ids[0] } else { ids[1] };
            match of_shell.unpack() {
                FeatureId::Vertex(point) => Some(point),
                _ => None,
            }
        });
        let manifold: ContactManifold<SPREAD_SIZE> = with_field!(self, &pose, margin, field => {
            let query = Query::new(self.tree, field, pose).with_margin(margin).with_motion(motion);
            hint.map_or(query, |point| query.with_hint(point)).manifold()
        });
        let contacts = manifold.contacts().iter();
        found.extend(contacts.map(|contact| self.on_surfaces(&pose, contact, margin)));
    }

    /// What a contact found before is now, if this shell's point was it.
    pub(crate) fn again(&self, pos12: &Pose3, ids: [PackedFeatureId; 2]) -> Option<PairContact> {
        let of_shell = if self.shell_is_first { ids[0] } else { ids[1] };
        let FeatureId::Vertex(point) = of_shell.unpack() else {
            return None;
        };
        let index = point as usize;
        if index >= self.tree.point_count() {
            return None;
        }
        let pose = self.shell_to_field(pos12);
        let (position, normal) = (self.tree.point(index), self.tree.normal(index));
        let (at, turned) = (pose.transform_point(position), pose.rotation * normal);
        let contact = Contact {
            point,
            position,
            normal,
            penetration: with_field!(self, &pose, 0.0, field => field.penetration(at, turned)),
        };
        Some(self.on_surfaces(&pose, &contact, 0.0))
    }

    /// The deepest contact of each segment of a level, told apart by segments and not by points.
    pub(crate) fn segments(
        &self,
        pos12: &Pose3,
        margin: f32,
        level: u32,
        found: &mut Vec<PairContact>,
    ) {
        let pose = self.shell_to_field(pos12);
        let level = level.clamp(1, self.tree.level_count());
        let visit = |segment, contact| {
            let mut contact = self.on_surfaces(&pose, &contact, margin);
            contact.ids = self.in_order(PackedFeatureId::face(segment), PackedFeatureId::UNKNOWN);
            found.push(contact);
        };
        with_field!(self, &pose, margin, field => {
            Query::new(self.tree, field, pose).with_margin(margin).for_each_segment(level, visit);
        });
    }

    /// The direction the first shape is pushed in by all points that are inside together, in its own
    /// frame, of length one or zero. Lists them all.
    pub(crate) fn push_on_first(&self, pos12: &Pose3) -> Vec3 {
        let pose = self.shell_to_field(pos12);
        let wrench = with_field!(self, &pose, 0.0, field => {
            Query::new(self.tree, field, pose).wrench(Vec3::ZERO, Weight::Area)
        });
        let on_shell = wrench.force.normalize_or_zero();
        if self.shell_is_first {
            on_shell
        } else {
            -(pose.rotation * on_shell)
        }
    }

    /// How finely the field is sampled: the size of its voxels in metres, 0 if it is exact.
    pub(crate) fn resolution(&self) -> f32 {
        match &self.field {
            Field::Trilinear(field) => field.voxel_size(),
            Field::Local(field) => field.voxel_size(),
            _ => 0.0,
        }
    }

    /// The size of the shell in metres.
    pub(crate) fn size(&self) -> f32 {
        self.tree.bounds().extents().length()
    }

    /// How far what the field says may be off anywhere in metres.
    pub(crate) fn error(&self) -> f32 {
        let of_field = match &self.field {
            Field::Trilinear(field) => field.error_bound(),
            Field::Local(field) => field.error_bound(),
            Field::Ball(field) => field.error_bound(),
            Field::Cuboid(field) => field.error_bound(),
            Field::HalfSpace(field) => field.error_bound(),
            Field::Other(nearby) => error_of(nearby.shape),
        };
        of_field + self.far_error
    }

    fn shell_to_field(&self, pos12: &Pose3) -> Pose3 {
        if self.shell_is_first {
            pos12.inverse()
        } else {
            *pos12
        }
    }

    /// Something of the shell and of the field as something of the first and of the second shape.
    fn in_order<T>(&self, of_shell: T, of_field: T) -> [T; 2] {
        if self.shell_is_first {
            [of_shell, of_field]
        } else {
            [of_field, of_shell]
        }
    }

    /// With the normal of the field, which does not depend on how the shell was sampled; where
    /// the field has none, that of the shell.
    fn on_surfaces(&self, shell_to_field: &Pose3, contact: &Contact, margin: f32) -> PairContact {
        let in_field = shell_to_field.transform_point(contact.position);
        let inward =
            with_field!(self, shell_to_field, margin, field => field.inward_direction(in_field));
        self.between(shell_to_field, contact, inward)
    }

    /// The same with a given direction into the solid.
    fn between(&self, shell_to_field: &Pose3, contact: &Contact, inward: Vec3) -> PairContact {
        let in_field = shell_to_field.transform_point(contact.position);
        let mut inward = inward;
        if inward == Vec3::ZERO {
            inward = -(shell_to_field.rotation * contact.normal);
        }
        let on_field = in_field - inward * contact.penetration;
        let of_shell = shell_to_field.rotation.inverse() * inward;
        let point = PackedFeatureId::vertex(contact.point);
        let by_shell = if self.shell_is_first {
            -contact.normal
        } else {
            shell_to_field.rotation * contact.normal
        };
        PairContact {
            points: self.in_order(contact.position, on_field),
            normals: self.in_order(of_shell, -inward),
            by_shell: Some(by_shell),
            shell_is_first: self.shell_is_first,
            ids: self.in_order(point, PackedFeatureId::UNKNOWN),
            penetration: contact.penetration,
        }
    }
}
