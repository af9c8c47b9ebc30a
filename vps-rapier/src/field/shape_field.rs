//! The field of any shape of parry, which is public.

use rapier3d::math::Pose;
use rapier3d::parry::query::PointQuery;
use rapier3d::parry::shape::{Shape, SharedShape, Triangle, TypedShape};
use vps_core::raw::{Discs, LANES};
use vps_core::{Aabb, DistanceField, Pose3, Vec3};

use super::bounds::{gap, shape_bounds, transformed};
use super::surface::Surface;
use super::surface_field::SurfaceField;
use crate::precision::{core_pose, core_real, core_vector, vector};

/// Any shape of parry as a distance field.
///
/// Points are projected on its surface, as exactly and as fast as parry does it. For meshes and height
/// fields the closest triangle is searched for.
/// * **Solids** (all convex shapes, triangle meshes with
///   [`TriMeshFlags::ORIENTED`](rapier3d::parry::shape::TriMeshFlags::ORIENTED)) have the interior
///   parry gives them.
/// * **Compounds** have the penetration of the part in which a point is deepest.
/// * **Open surfaces** (other triangle meshes, height fields, triangles) are the skin of a solid
///   `thickness` metres thick behind the side their triangles face, and end at their border.
/// * **Segments and polylines** have a penetration of at most 0.
/// * **Voxels** are not joined: a point has its depth in its own voxel.
pub struct ShapeField<'s> {
    kind: Kind<'s>,
    bounds: Aabb,
    error: f32,
    is_complete: bool,
}

enum Kind<'s> {
    /// Parts with their poses.
    Compound(Vec<(Pose3, ShapeField<'s>)>),
    Surface(SurfaceField<'s>),
    Triangle(&'s Triangle, f32),
    Projected(&'s dyn Shape),
}

impl<'s> ShapeField<'s> {
    /// The field of a shape, in the shape's frame; `thickness` in metres matters to open surfaces
    /// alone.
    pub fn new(shape: &'s dyn Shape, thickness: f32) -> Self {
        let all = shape_bounds(shape);
        Self::near(shape, thickness, all, f32::INFINITY)
    }

    /// The same field for points in the box `region`, in the shape's frame. Of compounds, meshes and
    /// height fields only the parts within `reach` metres of the box are used. At points in the box up
    /// to `reach` metres outside or inside of the shape the field is that of [`new`](Self::new), if
    /// `reach` is not less than `thickness`.
    pub fn near(shape: &'s dyn Shape, thickness: f32, region: Aabb, reach: f32) -> Self {
        let all = shape_bounds(shape);
        let projection_error = shape_error(shape);
        let mut is_complete = true;
        let (kind, skin, error) = match (Surface::of(shape), shape.as_typed_shape()) {
            (Some(surface), _) => {
                let skin = if surface.solid.is_some() {
                    0.0
                } else {
                    thickness
                };
                let field = SurfaceField::near(surface, thickness, region, reach);
                let error = field.error_bound();
                is_complete = field.is_complete();
                (Kind::Surface(field), skin, error)
            }
            (None, TypedShape::Compound(compound)) => {
                let part = |(pose, part): &'s (Pose, SharedShape)| {
                    let (pose, part): (_, &'s dyn Shape) = (core_pose(pose), &**part);
                    let region = transformed(&region, &pose.inverse());
                    let is_near = gap(&region, &shape_bounds(part)) <= reach;
                    is_near.then(|| (pose, Self::near(part, thickness, region, reach)))
                };
                let parts: Vec<_> = compound.shapes().iter().filter_map(part).collect();
                is_complete =
                    parts.len() == compound.shapes().len() && parts.iter().all(|p| p.1.is_complete);
                let errors = parts.iter().map(|(_, part)| part.error);
                let error = errors.fold(0.0, f32::max);
                (Kind::Compound(parts), thickness, error)
            }
            (None, TypedShape::Triangle(triangle)) => (
                Kind::Triangle(triangle, thickness),
                thickness,
                projection_error,
            ),
            _ => (Kind::Projected(shape), 0.0, projection_error),
        };
        Self {
            kind,
            bounds: Aabb {
                min: all.min - skin,
                max: all.max + skin,
            },
            error,
            is_complete,
        }
    }

    /// Whether no part was left out for its distance.
    pub(crate) fn is_complete(&self) -> bool {
        self.is_complete
    }

    /// The direction in which penetration grows, if it is the same all over the box.
    pub(crate) fn plane_direction(&self) -> Option<Vec3> {
        match &self.kind {
            Kind::Surface(surface) => surface.plane_direction(),
            _ => None,
        }
    }

    /// The penetration in metres, and the direction in which it grows.
    fn sample(&self, point: Vec3) -> (f32, Vec3) {
        let at = vector(point);
        let (projection, is_inside) = match &self.kind {
            Kind::Compound(parts) => {
                let parts = parts.iter().map(|(pose, part)| {
                    let (depth, inward) = part.sample(pose.inverse_transform_point(point));
                    (depth, pose.rotation * inward)
                });
                let deepest = parts.max_by(|a, b| a.0.total_cmp(&b.0));
                return deepest.unwrap_or((f32::NEG_INFINITY, Vec3::ZERO));
            }
            Kind::Surface(surface) => {
                return (
                    surface.penetration(point, Vec3::ZERO),
                    surface.inward_direction(point),
                );
            }
            Kind::Triangle(triangle, thickness) => {
                let on_surface = triangle.project_local_point(at, false).point;
                let offset = at - on_surface;
                let is_behind = offset.dot(triangle.scaled_normal()) < 0.0;
                let is_inside = is_behind && core_real(offset.length()) <= *thickness;
                (on_surface, is_inside)
            }
            Kind::Projected(shape) => {
                let projection = shape.project_local_point(at, false);
                (projection.point, projection.is_inside)
            }
        };
        let outward = point - core_vector(projection);
        let distance = outward.length();
        if is_inside {
            (distance, outward.normalize_or_zero())
        } else {
            (-distance, -outward.normalize_or_zero())
        }
    }
}

/// Error bound of the field of a shape in metres: 1e-4 of its size for parry's iterative projections,
/// rounding for triangles.
pub(crate) fn shape_error(shape: &dyn Shape) -> f32 {
    if Surface::of(shape).is_some() {
        let all = shape_bounds(shape);
        return 16.0 * f32::EPSILON * all.min.abs().max(all.max.abs()).max_element();
    }
    let radius = core_real(shape.compute_local_bounding_sphere().radius);
    if radius.is_finite() {
        1e-4 * radius
    } else {
        0.0
    }
}

impl DistanceField for ShapeField<'_> {
    fn penetration(&self, point: Vec3, normal: Vec3) -> f32 {
        match &self.kind {
            Kind::Surface(surface) => surface.penetration(point, normal),
            _ => self.sample(point).0,
        }
    }

    fn inward_direction(&self, point: Vec3) -> Vec3 {
        match &self.kind {
            Kind::Surface(surface) => surface.inward_direction(point),
            _ => self.sample(point).1,
        }
    }

    fn penetration_bound(&self, center: Vec3, radius: f32) -> f32 {
        match &self.kind {
            Kind::Compound(parts) => {
                let bounds = parts.iter().map(|(pose, part)| {
                    part.penetration_bound(pose.inverse_transform_point(center), radius)
                });
                // The transformation to the frame of a part adds rounding.
                bounds.fold(f32::NEG_INFINITY, f32::max) + self.error
            }
            Kind::Surface(surface) => surface.penetration_bound(center, radius),
            Kind::Triangle(_, thickness) => {
                let distance = self.sample(center).0.abs();
                let reach = radius + self.error;
                // Behind the triangle, the deepest point may be anywhere within the thickness.
                if distance - reach < *thickness {
                    (distance + reach).min(thickness + self.error)
                } else {
                    reach - distance
                }
            }
            Kind::Projected(_) => self.sample(center).0 + radius + self.error,
        }
    }

    fn penetration_bounds(&self, discs: &Discs) -> [f32; LANES] {
        match &self.kind {
            Kind::Surface(surface) => surface.penetration_bounds(discs),
            _ => std::array::from_fn(|i| {
                self.penetration_bound(discs.centers.get(i), discs.radii[i])
            }),
        }
    }

    fn bounds(&self) -> Aabb {
        self.bounds
    }

    fn error_bound(&self) -> f32 {
        self.error
    }
}
