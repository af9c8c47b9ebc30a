//! A distance field over the triangles of a surface near a shape.

use rapier3d::parry::query::PointQuery;
use vps_core::raw::{Discs, LANES};
use vps_core::{Aabb, DistanceField, Vec3};

use super::facet::{Facet, Junction};
use super::facet_tree::{ClosestPoint, FacetTree, Feature};
use super::plane::Plane;
use super::surface::Surface;
use crate::precision::{core_vector, vector};

/// The distance to the closest triangle. Its sign is the side of the closest feature a point lies on:
/// a face, or an edge or vertex with its pseudonormal. A flat ground is therefore flat however it is
/// triangulated.
///
/// Only triangles within `reach` metres of a box are used. In the box the field equals that of the
/// whole surface up to that distance; a solid mesh is asked itself about points further away. A
/// surface without an interior is the skin of a solid `thickness` metres thick behind the side it
/// faces, and ends at its border.
pub(crate) struct SurfaceField<'s> {
    surface: Surface<'s>,
    thickness: f32,
    region: Aabb,
    reach: f32,
    tree: FacetTree,
    /// Factor by which a point may be deeper than below the planes of all triangles: more than 1 where
    /// triangles meet in a concave edge or vertex.
    concavity: f32,
    error: f32,
    /// The plane all triangles lie in, if they do.
    plane: Option<Plane>,
}

/// The field at a point.
struct Sample {
    /// In metres, positive inside.
    penetration: f32,
    inward: Vec3,
}

impl<'s> SurfaceField<'s> {
    /// The field of the triangles within `reach` of the box `region`, both in the frame of the surface
    /// in metres.
    pub(crate) fn near(surface: Surface<'s>, thickness: f32, region: Aabb, reach: f32) -> Self {
        let all = surface.bounds();
        let bounds = Aabb {
            min: (region.min - reach).max(all.min),
            max: (region.max + reach).min(all.max),
        };
        let facets = surface.facets_in(&bounds);
        let size = |b: &Aabb| b.min.abs().max(b.max.abs()).max_element();
        let error = 16.0 * f32::EPSILON * size(&bounds).max(size(&region).min(size(&all)));
        let tree = FacetTree::new(facets);
        Self {
            surface,
            thickness,
            region,
            reach,
            concavity: concavity(tree.facets()),
            plane: Plane::of_facets(tree.facets(), &region, [reach, thickness], error),
            tree,
            error,
        }
    }

    /// Whether no triangle was left out for its distance.
    pub(crate) fn is_complete(&self) -> bool {
        let all = self.surface.bounds();
        (self.region.min - self.reach).cmple(all.min).all()
            && all.max.cmple(self.region.max + self.reach).all()
    }

    /// The direction in which penetration grows, if it is the same all over the box.
    pub(crate) fn plane_direction(&self) -> Option<Vec3> {
        self.plane.as_ref().map(|plane| -plane.normal)
    }

    /// Distance from a point up to which all triangles are in the tree.
    fn known_distance(&self, point: Vec3) -> f32 {
        self.reach - self.region.distance_outside(point)
    }

    fn sample(&self, point: Vec3) -> Sample {
        let closest = self.tree.closest(point);
        self.sample_solid(point, closest.as_ref())
            .unwrap_or_else(|| self.sample_facets(point, closest.as_ref()))
    }

    /// The sample of a solid mesh itself, where a triangle that is not in the tree may be closer.
    fn sample_solid(&self, point: Vec3, closest: Option<&ClosestPoint>) -> Option<Sample> {
        let mesh = self.surface.solid?;
        let is_known = closest.is_some_and(|c| c.squared.sqrt() <= self.known_distance(point));
        (!is_known).then(|| {
            let projection = mesh.project_local_point(vector(point), false);
            let outward = point - core_vector(projection.point);
            let distance = outward.length();
            let side = if projection.is_inside { 1.0 } else { -1.0 };
            Sample {
                penetration: side * distance,
                inward: outward.normalize_or_zero() * side,
            }
        })
    }

    /// The sample by the triangles in the tree, given the closest point on them.
    fn sample_facets(&self, point: Vec3, closest: Option<&ClosestPoint>) -> Sample {
        let Some(closest) = closest else {
            return Sample {
                penetration: f32::NEG_INFINITY,
                inward: Vec3::ZERO,
            };
        };
        let facet = &self.tree.facets()[closest.facet];
        let junction = match closest.feature {
            Feature::Face => None,
            Feature::Edge(edge) => Some(facet.edges[edge]),
            Feature::Vertex(corner) => Some(facet.vertices[corner]),
        };
        let normal = junction.map_or(facet.normal, |j| j.pseudonormal);
        let offset = point - closest.point;
        let height = offset.dot(normal);
        let lateral = (offset - normal * height).length();
        // Straight above or below, the closest point is only known up to rounding.
        let is_flat = junction.is_none_or(|j| j.is_flat() || j.is_border && lateral <= self.error);
        let distance = if is_flat {
            height.abs()
        } else {
            offset.length()
        };
        let is_beyond = self.surface.solid.is_none()
            && (distance > self.thickness || !is_flat && junction.is_some_and(|j| j.is_border));
        let is_inside = height < 0.0 && !is_beyond;
        let side = if is_inside { 1.0 } else { -1.0 };
        let inward = if is_flat && (is_inside || height >= 0.0) || distance <= self.error {
            -normal
        } else {
            offset.normalize_or_zero() * side
        };
        Sample {
            penetration: side * distance,
            inward,
        }
    }

    /// Upper bound of the penetration of a piece around `center`: `extent` gives how far the piece
    /// extends from there in a direction, `radius` how far it extends in any.
    fn bound(&self, center: Vec3, radius: f32, extent: impl Fn(Vec3) -> f32) -> f32 {
        let closest = self.tree.closest(center);
        if let Some(sample) = self.sample_solid(center, closest.as_ref()) {
            return sample.penetration + radius + self.error;
        }
        let Some(distance) = closest.map(|c| c.squared.sqrt()) else {
            return f32::NEG_INFINITY;
        };
        let ball = if self.surface.solid.is_some() {
            self.sample_facets(center, closest.as_ref()).penetration + radius
        } else if distance - radius > self.thickness {
            radius - distance
        } else {
            (distance + radius).min(self.thickness)
        };
        // A point of the piece is no closer to a triangle than to its plane. It is also no deeper than
        // below that plane, unless it is closest to a concave edge or vertex.
        let mut planes = f32::NEG_INFINITY;
        let within = distance + 2.0 * radius + self.error;
        self.tree.for_each_within(center, within * within, |facet| {
            planes = planes.max(extent(-facet.normal) - facet.height(center));
            planes < ball
        });
        if planes > 0.0 {
            planes *= self.concavity;
        }
        ball.min(planes) + self.error
    }
}

impl DistanceField for SurfaceField<'_> {
    #[inline]
    fn penetration(&self, point: Vec3, _normal: Vec3) -> f32 {
        match &self.plane {
            Some(plane) => plane.penetration(point),
            None => self.sample(point).penetration,
        }
    }

    fn inward_direction(&self, point: Vec3) -> Vec3 {
        match &self.plane {
            Some(plane) => -plane.normal,
            None => self.sample(point).inward,
        }
    }

    fn penetration_bound(&self, center: Vec3, radius: f32) -> f32 {
        match &self.plane {
            Some(plane) => plane.penetration(center) + radius,
            None => self.bound(center, radius, |_| radius),
        }
    }

    #[inline]
    fn penetration_bounds(&self, discs: &Discs) -> [f32; LANES] {
        if let Some(plane) = &self.plane {
            return std::array::from_fn(|lane| {
                let reach = discs.support(lane, -plane.normal);
                plane.penetration(discs.centers.get(lane)) + reach
            });
        }
        std::array::from_fn(|lane| {
            let extent = |direction| discs.support(lane, direction);
            self.bound(discs.centers.get(lane), discs.radii[lane], extent)
        })
    }

    fn bounds(&self) -> Aabb {
        self.surface.bounds()
    }

    fn error_bound(&self) -> f32 {
        self.error
    }
}

/// Factor for [`SurfaceField::concavity`]. A point closest to a concave edge or vertex is behind all
/// triangles that meet there, and no deeper than its depth below their mean plane divided by the
/// opening.
fn concavity(facets: &[Facet]) -> f32 {
    let junctions = facets.iter().flat_map(|f| [f.edges, f.vertices]).flatten();
    let concave = junctions.filter(|j: &Junction| j.is_concave && !j.is_flat());
    let least = concave.map(|j| j.opening).fold(1.0, f32::min);
    if least > 0.0 {
        1.0 / least
    } else {
        f32::INFINITY
    }
}
