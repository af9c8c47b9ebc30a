use rapier3d::math::Vector;
use rapier3d::parry::query::{PointProjection, PointQuery, PointQueryWithLocation};
use rapier3d::parry::shape::{Shape, TriMeshFlags, TypedShape};
use vps_core::{Aabb, DistanceField, Vec3};

use crate::real::{core_pose, core_real, core_vector, vector};

/// Any shape of parry as a distance field, by projecting points on its surface.
///
/// As exact, and as fast, as the shape's own projection.
/// * **Solids** (all convex shapes, triangle meshes with [`TriMeshFlags::ORIENTED`]) have the
///   interior parry gives them.
/// * **Compounds** are as deep as the deepest of their parts.
/// * **Open surfaces** (other triangle meshes, height fields, triangles) are taken as the skin of
///   something `thickness` metres thick behind the side their triangles face. Near a sharp edge
///   of a mesh that is not `ORIENTED`, the side may be told wrongly.
/// * **Segments and polylines** have penetration 0 at the most, and single **voxels** are not
///   joined: a point has the depth it has in its own voxel.
pub struct ShapeField<'s> {
    shape: &'s dyn Shape,
    thickness: f32,
}

impl<'s> ShapeField<'s> {
    /// The field of a shape, in the shape's frame; `thickness` is for open surfaces alone.
    pub fn new(shape: &'s dyn Shape, thickness: f32) -> Self {
        Self { shape, thickness }
    }

    /// The closest point of the surface, and the penetration. For a compound those of the part
    /// that is deepest.
    fn closest(&self, point: Vec3) -> (Vec3, f32) {
        let at = vector(point);
        let (projection, behind) = match self.shape.as_typed_shape() {
            TypedShape::Compound(compound) => {
                let parts = compound.shapes().iter().map(|(pose, part)| {
                    let pose = core_pose(pose);
                    let part = Self::new(&**part, self.thickness);
                    let (on_surface, depth) = part.closest(pose.inverse_transform_point(point));
                    (pose.transform_point(on_surface), depth)
                });
                return parts
                    .max_by(|a, b| a.1.total_cmp(&b.1))
                    .unwrap_or((point, f32::NEG_INFINITY));
            }
            TypedShape::TriMesh(mesh) if !mesh.flags().contains(TriMeshFlags::ORIENTED) => {
                let (projection, (triangle, _)) =
                    mesh.project_local_point_and_get_location(at, false);
                let normal = mesh.triangle(triangle).scaled_normal();
                (projection, (at - projection.point).dot(normal) < 0.0)
            }
            TypedShape::HeightField(field) => {
                let projection = field.project_local_point(at, false);
                (projection, at.y < projection.point.y)
            }
            TypedShape::Triangle(triangle) => {
                let projection = triangle.project_local_point(at, false);
                let behind = (at - projection.point).dot(triangle.scaled_normal()) < 0.0;
                (projection, behind)
            }
            _ => return solid(at, &self.shape.project_local_point(at, false)),
        };
        let on_surface = core_vector(projection.point);
        let distance = on_surface.distance(point);
        let inside = behind && distance <= self.thickness;
        (on_surface, if inside { distance } else { -distance })
    }

    /// Whether the penetration jumps from `thickness` to nothing on the far side.
    fn is_open(&self) -> bool {
        match self.shape.as_typed_shape() {
            TypedShape::Compound(compound) => compound
                .shapes()
                .iter()
                .any(|(_, part)| Self::new(&**part, self.thickness).is_open()),
            TypedShape::TriMesh(mesh) => !mesh.flags().contains(TriMeshFlags::ORIENTED),
            TypedShape::HeightField(_) | TypedShape::Triangle(_) => true,
            _ => false,
        }
    }
}

fn solid(point: Vector, projection: &PointProjection) -> (Vec3, f32) {
    let distance = core_real(projection.point.distance(point));
    let depth = if projection.is_inside {
        distance
    } else {
        -distance
    };
    (core_vector(projection.point), depth)
}

impl DistanceField for ShapeField<'_> {
    fn penetration(&self, point: Vec3, _normal: Vec3) -> f32 {
        self.closest(point).1
    }

    fn inward_direction(&self, point: Vec3) -> Vec3 {
        let (on_surface, depth) = self.closest(point);
        let outward = if depth > 0.0 {
            on_surface - point
        } else {
            point - on_surface
        };
        -outward.normalize_or_zero()
    }

    fn penetration_bound(&self, center: Vec3, radius: f32) -> f32 {
        let depth = self.penetration(center, Vec3::ZERO);
        let reach = radius + self.error_bound();
        let bound = depth + reach;
        // Behind an open surface the deepest point may be anywhere within its thickness.
        if self.is_open() && bound < self.thickness && reach - depth.abs() > -self.thickness {
            return (depth.abs() + reach).min(self.thickness + self.error_bound());
        }
        bound
    }

    fn bounds(&self) -> Aabb {
        let aabb = self.shape.compute_local_aabb();
        let skin = if self.is_open() { self.thickness } else { 0.0 };
        Aabb {
            min: core_vector(aabb.mins) - skin,
            max: core_vector(aabb.maxs) + skin,
        }
    }

    /// What parry's iterative projections may be off: a part in 10 000 of the shape's size.
    fn error_bound(&self) -> f32 {
        let radius = core_real(self.shape.compute_local_bounding_sphere().radius);
        if radius.is_finite() {
            1e-4 * radius
        } else {
            0.0
        }
    }
}
