//! The field of a VPS shape, continued beyond the grid of its voxelmap.

use vps_core::{Aabb, DistanceField, Trilinear, Vec3};

use crate::shape::VpsShape;

/// The field of a VPS shape. Outside of the grid, where the map has a lower bound of the distance
/// alone, it is the distance to the closest point of the shell: slower, and correct at any distance.
pub(crate) struct ExtendedMap<'s> {
    shape: &'s VpsShape,
    field: Trilinear<'s>,
}

impl<'s> ExtendedMap<'s> {
    pub(crate) fn new(shape: &'s VpsShape) -> Self {
        Self {
            shape,
            field: shape.asset().voxelmap.trilinear(),
        }
    }

    /// The penetration by the closest point of the shell.
    fn shell_penetration(&self, point: Vec3) -> f32 {
        let nearest = self.shape.nearest_of_shell(point);
        nearest.map_or(f32::NEG_INFINITY, |p| -p.distance(point))
    }
}

impl DistanceField for ExtendedMap<'_> {
    fn penetration(&self, point: Vec3, normal: Vec3) -> f32 {
        if self.shape.has_in_grid(point) {
            self.field.penetration(point, normal)
        } else {
            self.shell_penetration(point)
        }
    }

    fn inward_direction(&self, point: Vec3) -> Vec3 {
        self.field.inward_direction(point)
    }

    fn penetration_bound(&self, center: Vec3, radius: f32) -> f32 {
        let outside = self.shell_penetration(center) + radius;
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
