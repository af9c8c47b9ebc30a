//! The pointshell of one shape in the field of the other.

use std::cell::RefCell;
use std::rc::Rc;

use rapier3d::parry::shape::{FeatureId, PackedFeatureId, Shape, TypedShape};
use vps_core::{
    Approach, Ball, Contact, ContactManifold, Cuboid, DistanceField, HalfSpace, LocalPenetration,
    Observer, PointSphereTree, Pose3, Query, Trilinear, Vec3, Weight,
};

use super::event::{PairEvent, ShellObserver};
use super::pair_contact::PairContact;
use crate::field::bounds::transformed;
use crate::field::extended_map::ExtendedMap;
use crate::field::shape_field::{ShapeField, shape_error};
use crate::precision::{core_real, core_vector};
use crate::shape::VpsShape;

/// How a voxelmap is sampled between the centres of its voxels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sampling {
    /// Trilinear interpolation: penetration changes smoothly as a body rolls.
    #[default]
    Trilinear,
    /// Eq. 4 of the paper.
    Local,
}

/// Which point of the surface a contact has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ContactPoints {
    /// The deepest point of the surface around a point of the shell (contact refinement): depth is as
    /// exact as the fields, and changes smoothly as a body rolls. Voxelmaps sampled by eq. 4
    /// ([`Sampling::Local`]) jump between voxels and are not refined in; neither are segments.
    #[default]
    Refined,
    /// The point of the shell itself, as in the paper: depth is as exact as the points are close.
    Shell,
}

/// Distance of refined contacts of one deepest point, in spacings: points of a shell are further apart.
const MERGING_DISTANCE: f32 = 0.5;

/// Thickness of the solid behind an open surface, relative to the diagonal of the shell in it.
const SKIN_THICKNESS: f32 = 0.1;

/// Factor by which the search for a contact of a distant shape of parry widens at each attempt.
const SEARCH_GROWTH: f32 = 4.0;

/// A pointshell in a field.
pub(crate) struct ShellInField<'s> {
    tree: &'s PointSphereTree<'static>,
    field: Field<'s>,
    /// What contacts are refined by, unless they are points of the shell.
    refinement: Option<Refinement<'s>>,
    /// The VPS shape of the field, if it is one.
    field_shape: Option<&'s VpsShape>,
    /// Additional error of the field beyond the narrow band, in metres.
    far_error: f32,
    /// Whether the shell belongs to the first of the two shapes.
    shell_is_first: bool,
}

/// The surface that the points of a shell are samples of.
struct Refinement<'s> {
    /// In the frame of the shell.
    surface: Trilinear<'s>,
    /// Spacing of the points in metres.
    spacing: f32,
}

impl<'s> Refinement<'s> {
    fn of(shell: &'s VpsShape, contact_points: ContactPoints) -> Option<Self> {
        (contact_points == ContactPoints::Refined).then(|| Self {
            surface: shell.asset().voxelmap.trilinear(),
            spacing: shell.spacing(),
        })
    }
}

enum Field<'s> {
    Trilinear(Trilinear<'s>),
    Local(LocalPenetration<'s>),
    Ball(Ball),
    Cuboid(Cuboid),
    HalfSpace(HalfSpace),
    Other(LocalShape<'s>),
}

/// A shape of parry, of which only the parts near the shell become a field.
struct LocalShape<'s> {
    shape: &'s dyn Shape,
    /// Thickness of the solid behind an open surface, in metres.
    thickness: f32,
    /// The field of the previous query.
    cached: RefCell<Option<Rc<LocalField<'s>>>>,
}

/// The field of the parts of a shape within `reach` metres of the shell in a pose.
struct LocalField<'s> {
    pose: Pose3,
    reach: f32,
    field: ShapeField<'s>,
}

impl<'s> LocalShape<'s> {
    /// Calls `ask` with a field that is right up to `prediction` metres away from the shell.
    fn with_field<T>(
        &self,
        tree: &PointSphereTree<'_>,
        pose: &Pose3,
        prediction: f32,
        ask: impl FnOnce(&ShapeField<'s>) -> T,
    ) -> T {
        let reach = prediction.max(self.thickness);
        let cached = self.cached.borrow().clone();
        let cached = cached.filter(|c| c.pose == *pose && c.reach >= reach);
        let local = cached.unwrap_or_else(|| {
            let region = transformed(&tree.bounds(), pose);
            let field = ShapeField::near(self.shape, self.thickness, region, reach);
            let local = Rc::new(LocalField {
                pose: *pose,
                reach,
                field,
            });
            self.cached.replace(Some(local.clone()));
            local
        });
        ask(&local.field)
    }

    /// Whether the field of the previous query is that of the whole shape.
    fn is_complete(&self) -> bool {
        let cached = self.cached.borrow();
        cached.as_ref().is_some_and(|c| c.field.is_complete())
    }
}

/// Evaluates an expression with the field of a [`ShellInField`] as a variable of its own type. A query
/// is thus compiled for each kind of field and branches on it once, not at each point. The field is
/// right for contacts up to `$prediction` metres away in the pose.
macro_rules! with_field {
    ($shell:expr, $pose:expr, $prediction:expr, $field:ident => $body:expr) => {
        match &$shell.field {
            Field::Trilinear($field) => $body,
            Field::Local($field) => $body,
            Field::Ball($field) => $body,
            Field::Cuboid($field) => $body,
            Field::HalfSpace($field) => $body,
            Field::Other(local) => {
                local.with_field($shell.tree, $pose, $prediction, |$field| $body)
            }
        }
    };
}

impl<'s> ShellInField<'s> {
    /// The shell of one VPS shape in the voxelmap of another.
    pub(crate) fn in_map(
        shell: &'s VpsShape,
        field: &'s VpsShape,
        sampling: Sampling,
        contact_points: ContactPoints,
        shell_is_first: bool,
    ) -> Self {
        let map = &field.asset().voxelmap;
        Self {
            tree: &shell.asset().tree,
            refinement: match sampling {
                Sampling::Trilinear => Refinement::of(shell, contact_points),
                Sampling::Local => None,
            },
            field: match sampling {
                Sampling::Trilinear => Field::Trilinear(map.trilinear()),
                Sampling::Local => Field::Local(map.local()),
            },
            field_shape: Some(field),
            far_error: map.error_bounds().beyond,
            shell_is_first,
        }
    }

    /// The shell of a VPS shape in a shape of parry.
    pub(crate) fn in_shape(
        shell: &'s VpsShape,
        shape: &'s dyn Shape,
        contact_points: ContactPoints,
        shell_is_first: bool,
    ) -> Self {
        let thickness = SKIN_THICKNESS * shell.asset().tree.bounds().extents().length();
        let field = match shape.as_typed_shape() {
            TypedShape::Ball(ball) => Field::Ball(Ball::new(core_real(ball.radius))),
            TypedShape::Cuboid(cuboid) => {
                Field::Cuboid(Cuboid::new(core_vector(cuboid.half_extents)))
            }
            TypedShape::HalfSpace(half_space) => {
                Field::HalfSpace(HalfSpace::new(core_vector(half_space.normal)))
            }
            _ => Field::Other(LocalShape {
                shape,
                thickness,
                cached: RefCell::new(None),
            }),
        };
        Self {
            tree: &shell.asset().tree,
            field,
            refinement: Refinement::of(shell, contact_points),
            field_shape: None,
            far_error: 0.0,
            shell_is_first,
        }
    }

    /// Whether the whole shell may lie in the solid of a VPS shape, judged by their boxes.
    pub(crate) fn may_be_enclosed(&self, pos12: &Pose3) -> bool {
        let Some(shape) = self.field_shape else {
            return false;
        };
        let solid = shape.asset().voxelmap.solid();
        solid.may_contain(&self.tree.bounds(), &self.shell_to_field(pos12))
    }

    /// Whether the shell touches the solid, `pos12` being the pose of the second shape in the frame
    /// of the first.
    pub(crate) fn touches(&self, pos12: &Pose3) -> bool {
        let pose = self.shell_to_field(pos12);
        with_field!(self, &pose, 0.0, field => Query::new(self.tree, field, pose).touches())
            || self.refinement.is_some() && self.deepest(pos12, 0.0).is_some()
    }

    /// The deepest contact up to `prediction` metres away, refined from the deepest point of the shell.
    pub(crate) fn deepest(&self, pos12: &Pose3, prediction: f32) -> Option<PairContact> {
        let pose = self.shell_to_field(pos12);
        let (mut within, other) = match &self.field {
            // Distant parts of the shape are only used if nothing is near.
            Field::Other(local) => (prediction.min(self.size()), Some(local)),
            _ => (prediction, None),
        };
        // A point further out may stand for a deepest point within.
        let spacing = self.refinement.as_ref().map_or(0.0, |r| r.spacing);
        loop {
            let reach = within + spacing;
            let found = with_field!(self, &pose, reach, field => {
                Query::new(self.tree, field, pose).with_prediction(reach).deepest()
            });
            let refined = found.map(|contact| self.refined_contact(&pose, &contact, reach));
            let refined = refined.filter(|contact| contact.penetration >= -within);
            if refined.is_some() {
                return refined;
            }
            if within >= prediction {
                return None;
            }
            within = match other {
                Some(local) if !local.is_complete() => prediction.min(SEARCH_GROWTH * within),
                _ => prediction,
            };
        }
    }

    /// The normal out of the first shape that all contacts up to `prediction` metres away have, if the
    /// field is a single plane as far as that.
    pub(crate) fn plane_normal(&self, pos12: &Pose3, prediction: f32) -> Option<Vec3> {
        let pose = self.shell_to_field(pos12);
        let inward = match &self.field {
            Field::HalfSpace(field) => Some(field.inward_direction(Vec3::ZERO)),
            Field::Other(local) => {
                local.with_field(self.tree, &pose, prediction, ShapeField::plane_direction)
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

    /// The deepest contact up to `prediction` metres away. Its distance is right also outside of the
    /// grid of a map, where the field has a lower bound alone.
    pub(crate) fn closest(&self, pos12: &Pose3, prediction: f32) -> Option<PairContact> {
        let found = self.deepest(pos12, prediction)?;
        let Some(shape) = self.field_shape else {
            return Some(found);
        };
        let pose = self.shell_to_field(pos12);
        let shell_index = if self.shell_is_first { 0 } else { 1 };
        if shape.has_in_grid(pose.transform_point(found.points[shell_index])) {
            return Some(found);
        }
        let map = ExtendedMap::new(shape);
        let query = Query::new(self.tree, &map, pose);
        let mut contact = query.closest()?;
        if let Some(Refinement { surface, spacing }) = &self.refinement {
            contact = query.refine(&contact, surface, *spacing);
        }
        let in_field = pose.transform_point(contact.position);
        if shape.has_in_grid(in_field) {
            return Some(self.pair_contact(&pose, &contact, prediction));
        }
        let on_field = shape.closest_on_surface(in_field);
        let inward = (on_field - in_field).normalize_or_zero();
        let penetration = -on_field.distance(in_field);
        let exact = Contact {
            penetration,
            ..contact
        };
        (penetration >= -prediction).then(|| self.pair_contact_along(&pose, &exact, inward))
    }

    /// How far the shell may move, in metres, and meet nothing but one plane; 0 if that is unknown.
    pub(crate) fn plane_reach(&self, pos12: &Pose3) -> f32 {
        match (&self.field, self.plane_normal(pos12, 0.0)) {
            (Field::HalfSpace(_), _) => f32::INFINITY,
            (Field::Other(local), Some(_)) => local.thickness,
            _ => 0.0,
        }
    }

    /// The deepest of the contacts up to `prediction` metres away that `accept`s. `may_accept` is a
    /// cheaper test of a point of the shell and the shell's normal out of the first shape, both in the
    /// frame of the first.
    pub(crate) fn deepest_of(
        &self,
        pos12: &Pose3,
        prediction: f32,
        may_accept: &dyn Fn(Vec3, Vec3) -> bool,
        accept: &dyn Fn(&PairContact) -> bool,
    ) -> Option<PairContact> {
        let pose = self.shell_to_field(pos12);
        let mut deepest: Option<PairContact> = None;
        let visit = |contact: Contact| {
            if deepest.is_some_and(|d| d.penetration >= contact.penetration) {
                return;
            }
            let (point, outward) = if self.shell_is_first {
                (contact.position, -contact.normal)
            } else {
                let outward = pos12.rotation * contact.normal;
                (pos12.transform_point(contact.position), outward)
            };
            if !may_accept(point, outward) {
                return;
            }
            let contact = self.refined_contact(&pose, &contact, prediction);
            if accept(&contact) {
                deepest = Some(contact);
            }
        };
        with_field!(self, &pose, prediction, field => {
            Query::new(self.tree, field, pose).with_prediction(prediction).for_each_contact(visit);
        });
        deepest
    }

    /// Adds the deepest contact, then those that spread over the largest area, `N` at the most. The
    /// search is faster if the first of the `previous` contacts is still deep. `approach` is that
    /// of [`Query::with_approach`].
    pub(crate) fn manifold<const N: usize>(
        &self,
        pos12: &Pose3,
        prediction: f32,
        approach: Approach,
        previous: &[[PackedFeatureId; 2]],
        observer: &impl Observer<PairEvent>,
        found: &mut Vec<PairContact>,
    ) {
        let pose = self.shell_to_field(pos12);
        let hint = previous.first().and_then(|&ids| self.shell_point(ids));
        let manifold: ContactManifold<N> = with_field!(self, &pose, prediction, field => {
            let query = Query::new(self.tree, field, pose)
                .with_prediction(prediction)
                .with_approach(approach);
            let query = hint.map_or(query, |point| query.with_hint(point));
            query.observed_by(self.observer(observer)).manifold()
        });
        let contacts = manifold.contacts().iter();
        found.extend(contacts.map(|contact| self.refined_contact(&pose, contact, prediction)));
    }

    /// The observer of the query of this shell.
    fn observer<'o, O: Observer<PairEvent>>(&self, observer: &'o O) -> ShellObserver<'o, O> {
        ShellObserver {
            observer,
            shell_is_first: self.shell_is_first,
        }
    }

    /// The present contact of the point of an earlier one, if that was a point of this shell.
    pub(crate) fn re_evaluate(
        &self,
        pos12: &Pose3,
        ids: [PackedFeatureId; 2],
    ) -> Option<PairContact> {
        let point = self.shell_point(ids)?;
        let index = point as usize;
        if index >= self.tree.point_count() {
            return None;
        }
        let pose = self.shell_to_field(pos12);
        let (position, normal) = (self.tree.point(index), self.tree.normal(index));
        let (at, turned) = (pose.transform_point(position), pose.rotation * normal);
        let contact = Contact {
            point_index: point,
            position,
            normal,
            penetration: with_field!(self, &pose, 0.0, field => field.penetration(at, turned)),
        };
        Some(self.refined_contact(&pose, &contact, 0.0))
    }

    /// Adds the deepest contact of each segment of a level, identified by the segment.
    pub(crate) fn segments(
        &self,
        pos12: &Pose3,
        prediction: f32,
        level: u32,
        observer: &impl Observer<PairEvent>,
        found: &mut Vec<PairContact>,
    ) {
        let pose = self.shell_to_field(pos12);
        let level = level.clamp(1, self.tree.level_count());
        let visit = |segment, contact| {
            let mut contact = self.pair_contact(&pose, &contact, prediction);
            contact.ids = self.in_order(PackedFeatureId::face(segment), PackedFeatureId::UNKNOWN);
            found.push(contact);
        };
        with_field!(self, &pose, prediction, field => {
            let query = Query::new(self.tree, field, pose)
                .with_prediction(prediction)
                .observed_by(self.observer(observer));
            query.for_each_segment(level, visit);
        });
    }

    /// Unit direction of the force of all points inside on the first shape, in its frame, or zero.
    /// Visits all of these points.
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

    /// Size of the voxels of the field in metres, 0 if it is exact.
    pub(crate) fn resolution(&self) -> f32 {
        match &self.field {
            Field::Trilinear(field) => field.voxel_size(),
            Field::Local(field) => field.voxel_size(),
            _ => 0.0,
        }
    }

    /// The diagonal of the shell in metres.
    pub(crate) fn size(&self) -> f32 {
        self.tree.bounds().extents().length()
    }

    /// Error bound of the field anywhere, in metres.
    pub(crate) fn error(&self) -> f32 {
        let field_error = match &self.field {
            Field::Trilinear(field) => field.error_bound(),
            Field::Local(field) => field.error_bound(),
            Field::Ball(field) => field.error_bound(),
            Field::Cuboid(field) => field.error_bound(),
            Field::HalfSpace(field) => field.error_bound(),
            Field::Other(local) => shape_error(local.shape),
        };
        field_error + self.far_error
    }

    fn shell_to_field(&self, pos12: &Pose3) -> Pose3 {
        if self.shell_is_first {
            pos12.inverse()
        } else {
            *pos12
        }
    }

    /// The point of the shell the ids of a contact stand for.
    fn shell_point(&self, ids: [PackedFeatureId; 2]) -> Option<u32> {
        let shell_id = if self.shell_is_first { ids[0] } else { ids[1] };
        match shell_id.unpack() {
            FeatureId::Vertex(point) => Some(point),
            _ => None,
        }
    }

    /// A value of the shell's shape and one of the field's, in the order of the two shapes.
    fn in_order<T>(&self, of_shell: T, of_field: T) -> [T; 2] {
        if self.shell_is_first {
            [of_shell, of_field]
        } else {
            [of_field, of_shell]
        }
    }

    /// The contact of the pair at the deepest point of the surface around the point of the shell.
    fn refined_contact(&self, pose: &Pose3, contact: &Contact, prediction: f32) -> PairContact {
        let contact = match &self.refinement {
            Some(Refinement { surface, spacing }) => {
                with_field!(self, pose, prediction, field => {
                    Query::new(self.tree, field, *pose).refine(contact, surface, *spacing)
                })
            }
            None => *contact,
        };
        self.pair_contact(pose, &contact, prediction)
    }

    /// Distance in metres within which two contacts with the same normal are of one deepest point, where
    /// contacts are refined; otherwise 0.
    pub(crate) fn merging_distance(&self) -> f32 {
        let refinement = self.refinement.as_ref();
        refinement.map_or(0.0, |refinement| MERGING_DISTANCE * refinement.spacing)
    }

    /// The contact of the pair, with the normal of the field, which does not depend on how the shell
    /// was sampled. Where the field has none, the normal is the shell's.
    fn pair_contact(
        &self,
        shell_to_field: &Pose3,
        contact: &Contact,
        prediction: f32,
    ) -> PairContact {
        let in_field = shell_to_field.transform_point(contact.position);
        let inward = with_field!(self, shell_to_field, prediction, field => {
            field.inward_direction(in_field)
        });
        self.pair_contact_along(shell_to_field, contact, inward)
    }

    /// The contact of the pair with a given direction into the solid, in the frame of the field.
    fn pair_contact_along(
        &self,
        shell_to_field: &Pose3,
        contact: &Contact,
        inward: Vec3,
    ) -> PairContact {
        let in_field = shell_to_field.transform_point(contact.position);
        let mut inward = inward;
        if inward == Vec3::ZERO {
            inward = -(shell_to_field.rotation * contact.normal);
        }
        let on_field = in_field - inward * contact.penetration;
        let out_of_shell = shell_to_field.rotation.inverse() * inward;
        let point = PackedFeatureId::vertex(contact.point_index);
        let shell_normal = if self.shell_is_first {
            -contact.normal
        } else {
            shell_to_field.rotation * contact.normal
        };
        PairContact {
            points: self.in_order(contact.position, on_field),
            normals: self.in_order(out_of_shell, -inward),
            shell_normal: Some(shell_normal),
            shell_is_first: self.shell_is_first,
            ids: self.in_order(point, PackedFeatureId::UNKNOWN),
            penetration: contact.penetration,
        }
    }
}
