use rapier3d::parry::query::PointQuery;
use rapier3d::parry::shape::{Shape, Triangle, TypedShape};
use vps_core::{Aabb, Discs, DistanceField, LANES, Pose3, Vec3};

use crate::real::{core_pose, core_real, core_vector, vector};
use crate::surface::Surface;
use crate::surface_field::SurfaceField;

/// Any shape of parry as a distance field.
///
/// Points are projected on its surface, as exactly and as fast as parry does it; the triangles of
/// meshes and height fields are looked at one by one.
/// * **Solids** (all convex shapes, triangle meshes with
///   [`TriMeshFlags::ORIENTED`](rapier3d::parry::shape::TriMeshFlags::ORIENTED)) have the interior
///   parry gives them.
/// * **Compounds** are as deep as the deepest of their parts.
/// * **Open surfaces** (other triangle meshes, height fields, triangles) are taken as the skin of
///   something `thickness` metres thick behind the side their triangles face, and end at their
///   border.
/// * **Segments and polylines** have penetration 0 at the most, and single **voxels** are not
///   joined: a point has the depth it has in its own voxel.
pub struct ShapeField<'s> {
    kind: Kind<'s>,
    bounds: Aabb,
    error: f32,
    is_all: bool,
}

enum Kind<'s> {
    /// Parts with their poses.
    Compound(Vec<(Pose3, ShapeField<'s>)>),
    Surface(SurfaceField<'s>),
    Triangle(&'s Triangle, f32),
    Projected(&'s dyn Shape),
}

impl<'s> ShapeField<'s> {
    /// The field of a shape, in the shape's frame; `thickness` is for open surfaces alone.
    pub fn new(shape: &'s dyn Shape, thickness: f32) -> Self {
        let all = bounds(shape);
        Self::near(shape, thickness, all, f32::INFINITY)
    }

    /// The same where no more of a compound, a mesh or a height field is taken than what is within
    /// `reach` metres of `around`, a box in the shape's frame. It is the same field for points in that
    /// box that are up to `reach` metres outside of the shape or inside of it, if `reach` is not less
    /// than `thickness`; it is for points in that box alone.
    pub fn near(shape: &'s dyn Shape, thickness: f32, around: Aabb, reach: f32) -> Self {
        let all = bounds(shape);
        let of_projection = error_of(shape);
        let mut is_all = true;
        let (kind, skin, error) = match (Surface::of(shape), shape.as_typed_shape()) {
            (Some(surface), _) => {
                let skin = if surface.solid.is_some() {
                    0.0
                } else {
                    thickness
                };
                let field = SurfaceField::near(surface, thickness, around, reach);
                let error = field.error_bound();
                is_all = field.is_all();
                (Kind::Surface(field), skin, error)
            }
            (None, TypedShape::Compound(compound)) => {
                let part = |(pose, part): &'s (_, _)| {
                    let (pose, part): (Pose3, &'s dyn Shape) = (core_pose(pose), shape_of(part));
                    let around = moved(&around, &pose.inverse());
                    let is_near = gap(&around, &bounds(part)) <= reach;
                    is_near.then(|| (pose, Self::near(part, thickness, around, reach)))
                };
                let parts: Vec<_> = compound.shapes().iter().filter_map(part).collect();
                is_all = parts.len() == compound.shapes().len() && parts.iter().all(|p| p.1.is_all);
                let errors = parts.iter().map(|(_, part)| part.error);
                let error = errors.fold(0.0, f32::max);
                (Kind::Compound(parts), thickness, error)
            }
            (None, TypedShape::Triangle(triangle)) => (
                Kind::Triangle(triangle, thickness),
                thickness,
                of_projection,
            ),
            _ => (Kind::Projected(shape), 0.0, of_projection),
        };
        Self {
            kind,
            bounds: Aabb {
                min: all.min - skin,
                max: all.max + skin,
            },
            error,
            is_all,
        }
    }

    /// Whether nothing was left out for being too far away.
    pub(crate) fn is_all(&self) -> bool {
        self.is_all
    }

    /// The direction in which penetration grows, if it is the same all over the box.
    pub(crate) fn level_direction(&self) -> Option<Vec3> {
        match &self.kind {
            Kind::Surface(surface) => surface.level_direction(),
            _ => None,
        }
    }

    /// The penetration, and the direction in which it grows.
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
                let away = at - on_surface;
                let is_behind = away.dot(triangle.scaled_normal()) < 0.0;
                let is_inside = is_behind && core_real(away.length()) <= *thickness;
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

/// A part of a compound.
fn shape_of(part: &rapier3d::parry::shape::SharedShape) -> &dyn Shape {
    &**part
}

fn bounds(shape: &dyn Shape) -> Aabb {
    let aabb = shape.compute_local_aabb();
    Aabb {
        min: core_vector(aabb.mins),
        max: core_vector(aabb.maxs),
    }
}

/// What the field of a shape may be off, in metres: of parry's iterative projections a part in 10 000
/// of the shape's size, of triangles rounding.
pub(crate) fn error_of(shape: &dyn Shape) -> f32 {
    if Surface::of(shape).is_some() {
        let all = bounds(shape);
        return 16.0 * f32::EPSILON * all.min.abs().max(all.max.abs()).max_element();
    }
    let radius = core_real(shape.compute_local_bounding_sphere().radius);
    if radius.is_finite() {
        1e-4 * radius
    } else {
        0.0
    }
}

/// What holds a box in another frame.
pub(crate) fn moved(bounds: &Aabb, pose: &Pose3) -> Aabb {
    let axes = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| (pose.rotation * axis).abs());
    let half = 0.5 * bounds.extents();
    let reach = axes[0] * half.x + axes[1] * half.y + axes[2] * half.z;
    let center = pose.transform_point(bounds.center());
    Aabb {
        min: center - reach,
        max: center + reach,
    }
}

/// How far two boxes are apart along the axis where they are furthest apart.
fn gap(a: &Aabb, b: &Aabb) -> f32 {
    (a.min - b.max).max(b.min - a.max).max_element()
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
                // What is in another frame is rounded once more.
                bounds.fold(f32::NEG_INFINITY, f32::max) + self.error
            }
            Kind::Surface(surface) => surface.penetration_bound(center, radius),
            Kind::Triangle(_, thickness) => {
                let distance = self.sample(center).0.abs();
                let reach = radius + self.error;
                // Behind it the deepest point may be anywhere within its thickness.
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
