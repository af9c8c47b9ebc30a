//! The triangles of a mesh or a height field that lie in a box.

use rapier3d::parry::bounding_volume::Aabb as ParryAabb;
use rapier3d::parry::shape::{Shape, TriMesh, TriMeshFlags, Triangle, TypedShape};
use vps_core::Aabb;

use super::adjacency::{connect, vertex_key};
use super::bounds::shape_bounds;
use super::facet::Facet;
use crate::precision::{core_vector, vector};

/// A triangle mesh or a height field.
#[derive(Clone, Copy)]
pub(crate) struct Surface<'s> {
    shape: &'s dyn Shape,
    /// The mesh, if it has an interior.
    pub(crate) solid: Option<&'s TriMesh>,
}

impl<'s> Surface<'s> {
    /// `None` for shapes that are not made of triangles alone.
    pub(crate) fn of(shape: &'s dyn Shape) -> Option<Self> {
        let solid = match shape.as_typed_shape() {
            TypedShape::TriMesh(mesh) => {
                Some(mesh).filter(|m| m.flags().contains(TriMeshFlags::ORIENTED))
            }
            TypedShape::HeightField(_) => None,
            _ => return None,
        };
        Some(Self { shape, solid })
    }

    /// A box around all of it.
    pub(crate) fn bounds(&self) -> Aabb {
        shape_bounds(self.shape)
    }

    /// All triangles that reach into a box, in the order of their numbers. Triangles at the border of
    /// the box may have neighbours outside of it, which are not taken into account.
    pub(crate) fn facets_in(&self, bounds: &Aabb) -> Vec<Facet> {
        // Coordinates of the shape may have 64 bits, and lie a rounding beyond a bound made of them.
        let rounding = f32::EPSILON * bounds.min.abs().max(bounds.max.abs()).max_element();
        let region = ParryAabb::new(vector(bounds.min - rounding), vector(bounds.max + rounding));
        let mut found = Vec::new();
        let mut degenerate = Vec::new();
        let mut add = |number, triangle: &Triangle, vertices| {
            let aabb = triangle.local_aabb();
            let overlaps = aabb.mins.cmple(region.maxs) & region.mins.cmple(aabb.maxs);
            if !overlaps.all() {
                return;
            }
            match triangle.scaled_normal().try_normalize() {
                Some(normal) => {
                    let corners = [triangle.a, triangle.b, triangle.c].map(core_vector);
                    found.push((Facet::new(number, corners, core_vector(normal)), vertices));
                }
                None => degenerate.push(vertices),
            }
        };
        match self.shape.as_typed_shape() {
            TypedShape::TriMesh(mesh) => {
                for number in mesh.bvh().intersect_aabb(&region) {
                    let triangle = mesh.triangle(number);
                    let vertices = [triangle.a, triangle.b, triangle.c].map(vertex_key);
                    add(number, &triangle, vertices);
                }
            }
            TypedShape::HeightField(field) => {
                field.map_elements_in_local_aabb(&region, &mut |number, triangle: &Triangle| {
                    let vertices = field.triangle_vids_at_id(number);
                    let vertices = vertices.unwrap_or_default().map(|v| [v, 0, 0]);
                    add(number, triangle, vertices);
                });
            }
            _ => {}
        }
        found.sort_unstable_by_key(|(facet, _)| facet.number);
        let (mut facets, vertices): (Vec<Facet>, Vec<_>) = found.into_iter().unzip();
        connect(&mut facets, &vertices, &degenerate);
        facets
    }
}
