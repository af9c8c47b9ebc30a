use rapier3d::parry::shape::Shape;
use vps_core::{Aabb, DistanceField, Vec3};

/// Any shape of parry as a distance field, by projecting points on its surface.
///
/// As exact, and as fast, as the shape's own projection. Shapes without an interior (triangle
/// meshes, height fields, segments) have penetration 0 at the most.
pub struct ShapeField<'s>(&'s dyn Shape);

impl<'s> ShapeField<'s> {
    /// The field of a shape, in the shape's frame.
    pub fn new(shape: &'s dyn Shape) -> Self {
        Self(shape)
    }
}

impl DistanceField for ShapeField<'_> {
    fn penetration(&self, point: Vec3, _normal: Vec3) -> f32 {
        let projection = self.0.project_local_point(point, false);
        let distance = projection.point.distance(point);
        if projection.is_inside {
            distance
        } else {
            -distance
        }
    }

    fn inward_direction(&self, point: Vec3) -> Vec3 {
        let projection = self.0.project_local_point(point, false);
        let to_surface = (projection.point - point).normalize_or_zero();
        if projection.is_inside {
            -to_surface
        } else {
            to_surface
        }
    }

    fn penetration_bound(&self, center: Vec3, radius: f32) -> f32 {
        self.penetration(center, Vec3::ZERO) + radius + self.error_bound()
    }

    fn bounds(&self) -> Aabb {
        let aabb = self.0.compute_local_aabb();
        Aabb {
            min: aabb.mins,
            max: aabb.maxs,
        }
    }

    /// What parry's iterative projections may be off, measured against closed forms: a part in
    /// 10 000 of the shape's size.
    fn error_bound(&self) -> f32 {
        let radius = self.0.compute_local_bounding_sphere().radius;
        if radius.is_finite() {
            1e-4 * radius
        } else {
            0.0
        }
    }
}
