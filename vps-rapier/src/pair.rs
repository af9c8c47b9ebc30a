use rapier3d::math::Pose;
use rapier3d::parry::shape::{Shape, TypedShape};
use vps_core::{
    Ball, Contact, ContactManifold, Cuboid, DistanceField, HalfSpace, LocalPenetration,
    PointSphereTree, Query, Trilinear, Vec3,
};

use crate::{ShapeField, VpsShape};

/// How a voxelmap is sampled between the centres of its voxels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sampling {
    /// Trilinear interpolation: penetration changes smoothly as a body rolls.
    #[default]
    Trilinear,
    /// Eq. 4 of the paper.
    Local,
}

/// Evaluates an expression with the field of a pair as a variable of its own type, so that a query
/// is compiled for each kind of field and decides nothing a point.
macro_rules! with_field {
    ($pair:expr, $field:ident => $body:expr) => {
        match &$pair.field {
            $crate::pair::Field::Trilinear($field) => $body,
            $crate::pair::Field::Local($field) => $body,
            $crate::pair::Field::Ball($field) => $body,
            $crate::pair::Field::Cuboid($field) => $body,
            $crate::pair::Field::HalfSpace($field) => $body,
            $crate::pair::Field::Other($field) => $body,
        }
    };
}
/// Two shapes of which one is taken as the shell and the other as the field.
pub(crate) struct Pair<'s> {
    pub(crate) tree: &'s PointSphereTree<'static>,
    pub(crate) field: Field<'s>,
    /// Whether the first of the two shapes is the shell.
    pub(crate) shell_is_first: bool,
}

/// The field of a pair.
pub(crate) enum Field<'s> {
    Trilinear(Trilinear<'s>),
    Local(LocalPenetration<'s>),
    Ball(Ball),
    Cuboid(Cuboid),
    HalfSpace(HalfSpace),
    Other(ShapeField<'s>),
}

impl<'s> Pair<'s> {
    /// `None` if neither shape is a VPS shape.
    pub(crate) fn of(g1: &'s dyn Shape, g2: &'s dyn Shape, sampling: Sampling) -> Option<Self> {
        let vps = |g: &'s dyn Shape| g.as_shape::<VpsShape>();
        let (shell, field, shell_is_first) = match (vps(g1), vps(g2)) {
            (None, None) => return None,
            (Some(a), None) => (a, Field::of_shape(g2, a), true),
            (None, Some(b)) => (b, Field::of_shape(g1, b), false),
            (Some(a), Some(b)) => {
                let points = |s: &VpsShape| s.asset().tree.point_count();
                let first = match a.role().cmp(&b.role()) {
                    std::cmp::Ordering::Equal => points(a) <= points(b),
                    order => order.is_gt(),
                };
                let (shell, field) = if first { (a, b) } else { (b, a) };
                (shell, Field::of_map(field, sampling), first)
            }
        };
        Some(Self {
            tree: &shell.asset().tree,
            field,
            shell_is_first,
        })
    }

    /// The direction in which penetration grows, in the field frame.
    pub(crate) fn inward_direction(&self, point: Vec3) -> Vec3 {
        with_field!(self, field => field.inward_direction(point))
    }

    /// A few of the contacts up to `margin` metres away, `pos12` being the pose of the second shape
    /// in the frame of the first; found faster if the deepest is known from the step before.
    pub(crate) fn manifold<const N: usize>(
        &self,
        pos12: &Pose,
        margin: f32,
        hint: Option<u32>,
    ) -> ContactManifold<N> {
        let pose = self.shell_to_field(pos12);
        with_field!(self, field => {
            let query = Query::new(self.tree, field, pose).with_margin(margin);
            hint.map_or(query, |point| query.with_hint(point)).manifold()
        })
    }

    /// The deepest contact up to `margin` metres away.
    pub(crate) fn deepest(&self, pos12: &Pose, margin: f32) -> Option<Contact> {
        let pose = self.shell_to_field(pos12);
        with_field!(self, field => Query::new(self.tree, field, pose).with_margin(margin).deepest())
    }

    pub(crate) fn touches(&self, pos12: &Pose) -> bool {
        let pose = self.shell_to_field(pos12);
        with_field!(self, field => Query::new(self.tree, field, pose).touches())
    }

    /// How finely the field is sampled: the size of its voxels in metres, 0 if it is exact.
    pub(crate) fn resolution(&self) -> f32 {
        match &self.field {
            Field::Trilinear(field) => field.voxel_size(),
            Field::Local(field) => field.voxel_size(),
            _ => 0.0,
        }
    }

    /// A distance in metres that every point of the shell has at least from the solid; less than
    /// the true one by the errors of the field, never more. Tests every point.
    pub(crate) fn clearance(&self, pos12: &Pose) -> f32 {
        let pose = self.shell_to_field(pos12);
        let points = (0..self.tree.point_count()).map(|i| pose.transform_point(self.tree.point(i)));
        with_field!(self, field => points
            .map(|p| -field.penetration_bound(p, 0.0))
            .fold(f32::INFINITY, f32::min))
    }

    pub(crate) fn shell_to_field(&self, pos12: &Pose) -> Pose {
        if self.shell_is_first {
            pos12.inverse()
        } else {
            *pos12
        }
    }

    /// Something of the shell and of the field as something of the first and of the second shape.
    pub(crate) fn in_order<T>(&self, of_shell: T, of_field: T) -> (T, T) {
        if self.shell_is_first {
            (of_shell, of_field)
        } else {
            (of_field, of_shell)
        }
    }
}

impl<'s> Field<'s> {
    fn of_map(shape: &'s VpsShape, sampling: Sampling) -> Self {
        let map = &shape.asset().voxelmap;
        match sampling {
            Sampling::Trilinear => Self::Trilinear(map.trilinear()),
            Sampling::Local => Self::Local(map.local()),
        }
    }

    fn of_shape(shape: &'s dyn Shape, shell: &VpsShape) -> Self {
        // An open surface holds a body that is through it by up to a tenth of its size.
        let thickness = 0.1 * shell.asset().tree.bounds().extents().length();
        match shape.as_typed_shape() {
            TypedShape::Ball(ball) => Self::Ball(Ball::new(ball.radius)),
            TypedShape::Cuboid(cuboid) => Self::Cuboid(Cuboid::new(cuboid.half_extents)),
            TypedShape::HalfSpace(half_space) => Self::HalfSpace(HalfSpace::new(half_space.normal)),
            _ => Self::Other(ShapeField::new(shape, thickness)),
        }
    }
}
