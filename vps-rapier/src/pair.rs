use rapier3d::math::Pose;
use rapier3d::parry::shape::{Shape, TypedShape};
use vps_core::{
    Ball, Cuboid, DistanceField, HalfSpace, LocalPenetration, PointSphereTree, Query, Trilinear,
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

/// Two shapes of which one is taken as the shell and the other as the field.
pub(crate) struct Pair<'s> {
    pub(crate) tree: &'s PointSphereTree<'static>,
    field: Field<'s>,
    /// Whether the first of the two shapes is the shell.
    pub(crate) shell_is_first: bool,
}

enum Field<'s> {
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
            (Some(a), None) => (a, Field::of_shape(g2), true),
            (None, Some(b)) => (b, Field::of_shape(g1), false),
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

    pub(crate) fn field(&self) -> &dyn DistanceField {
        match &self.field {
            Field::Trilinear(field) => field,
            Field::Local(field) => field,
            Field::Ball(field) => field,
            Field::Cuboid(field) => field,
            Field::HalfSpace(field) => field,
            Field::Other(field) => field,
        }
    }

    /// A query of the pair, `pos12` being the pose of the second shape in the frame of the first.
    pub(crate) fn query(&self, pos12: &Pose) -> Query<'_, dyn DistanceField + '_> {
        Query::new(self.tree, self.field(), self.shell_to_field(pos12))
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

    fn of_shape(shape: &'s dyn Shape) -> Self {
        match shape.as_typed_shape() {
            TypedShape::Ball(ball) => Self::Ball(Ball::new(ball.radius)),
            TypedShape::Cuboid(cuboid) => Self::Cuboid(Cuboid::new(cuboid.half_extents)),
            TypedShape::HalfSpace(half_space) => Self::HalfSpace(HalfSpace::new(half_space.normal)),
            _ => Self::Other(ShapeField::new(shape)),
        }
    }
}
