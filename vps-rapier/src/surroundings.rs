use vps_core::{Aabb, Ball, DistanceField, Pose3, Query, Trilinear, Vec3};

use crate::VpsShape;

/// The field of a VPS shape, and around its grid, where the map knows bounds alone, the distance of the
/// closest point of its shell: slower, and right however far away.
pub(crate) struct Surroundings<'s> {
    shape: &'s VpsShape,
    field: Trilinear<'s>,
}

impl<'s> Surroundings<'s> {
    pub(crate) fn new(shape: &'s VpsShape) -> Self {
        Self {
            shape,
            field: shape.asset().voxelmap.trilinear(),
        }
    }

    fn of_shell(&self, point: Vec3) -> f32 {
        nearest_of_shell(self.shape, point).map_or(f32::NEG_INFINITY, |p| -p.distance(point))
    }
}

/// The point of a shell that is closest to a point; none to one that is not finite.
pub(crate) fn nearest_of_shell(shape: &VpsShape, point: Vec3) -> Option<Vec3> {
    let point_field = Ball::new(f32::MIN_POSITIVE);
    let pose = Pose3::from_translation(-point);
    let query = Query::new(&shape.asset().tree, &point_field, pose);
    query.closest().map(|contact| contact.position)
}

impl DistanceField for Surroundings<'_> {
    fn penetration(&self, point: Vec3, normal: Vec3) -> f32 {
        if self.shape.has_in_grid(point) {
            self.field.penetration(point, normal)
        } else {
            self.of_shell(point)
        }
    }

    fn inward_direction(&self, point: Vec3) -> Vec3 {
        self.field.inward_direction(point)
    }

    fn penetration_bound(&self, center: Vec3, radius: f32) -> f32 {
        let outside = self.of_shell(center) + radius;
        let grid = self.field.grid().bounds();
        if grid.distance_outside(center) > radius {
            outside
        } else {
            outside.max(self.field.penetration_bound(center, radius))
        }
    }

    fn bounds(&self) -> Aabb {
        self.field.bounds()
    }

    fn error_bound(&self) -> f32 {
        self.field.error_bound()
    }
}
