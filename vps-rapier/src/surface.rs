//! The triangles of a surface that are near a shape, and what they make of their edges.

use std::collections::BTreeMap;

use rapier3d::math::Vector;
use rapier3d::parry::bounding_volume::Aabb as ParryAabb;
use rapier3d::parry::shape::{Shape, TriMesh, TriMeshFlags, Triangle, TypedShape};
use vps_core::{Aabb, Vec3};

use crate::real::{core_vector, vector};

/// How two triangles meet at an edge, or how many meet at a corner, seen from the side they face; of a
/// corner the width is not known.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Seam {
    /// The mean of the normals of the triangles that meet, of length one; zero if they cancel.
    pub(crate) normal: Vec3,
    /// The cosine between that and the normal that is furthest from it.
    pub(crate) opening: f32,
    /// Whether the surface ends here.
    pub(crate) is_border: bool,
    /// Whether some of it bends towards the side it faces.
    pub(crate) is_hollow: bool,
    /// How wide the narrowest of the triangles is that meet, in metres.
    pub(crate) width: f32,
}

/// Up to here a seam is as good as none: single precision cannot tell normals apart that are closer.
const FLAT: f32 = 1.0 - 1e-6;

impl Seam {
    /// Whether all that meets is in one plane.
    pub(crate) fn is_flat(&self) -> bool {
        !self.is_border && self.opening > FLAT
    }

    /// Whether an edge is a ridge or a border that points of a shell may miss: one with at most a cosine
    /// between its normal and those of its triangles, or any where one of those is narrower than a
    /// width, so that the points may miss it altogether.
    pub(crate) fn stands_out(&self, bluntest: f32, narrowest: f32) -> bool {
        let is_ridge = !self.is_hollow && self.opening < FLAT;
        let is_missed = self.opening < bluntest || self.width < narrowest;
        self.is_border || is_ridge && is_missed
    }
}

/// A triangle with its neighbours taken into account.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Facet {
    /// Its number in the shape.
    pub(crate) number: u32,
    /// In metres, in the frame of the shape.
    pub(crate) corners: [Vec3; 3],
    /// Of length one, out of the side the triangle faces.
    pub(crate) normal: Vec3,
    /// The edge from each corner to the next.
    pub(crate) edges: [Seam; 3],
    /// Whether an edge is another facet's, too, that comes before this one.
    pub(crate) is_shared: [bool; 3],
    pub(crate) vertices: [Seam; 3],
}

/// A triangle mesh or a height field.
#[derive(Clone, Copy)]
pub(crate) struct Surface<'s> {
    shape: &'s dyn Shape,
    /// Whether it has an interior.
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
        let aabb = self.shape.compute_local_aabb();
        Aabb {
            min: core_vector(aabb.mins),
            max: core_vector(aabb.maxs),
        }
    }

    /// All triangles that reach into a box, in the order of their numbers. Those at its border do not
    /// know all of their neighbours.
    pub(crate) fn facets_in(&self, bounds: &Aabb) -> Vec<Facet> {
        // The shape's own numbers may have 64 bits, and lie a rounding beyond a border made of them.
        let rounding = f32::EPSILON * bounds.min.abs().max(bounds.max.abs()).max_element();
        let around = ParryAabb::new(vector(bounds.min - rounding), vector(bounds.max + rounding));
        let mut found = Vec::new();
        let mut flat = Vec::new();
        let mut add = |number, triangle: &Triangle, vertices| {
            let aabb = triangle.local_aabb();
            let overlaps = aabb.mins.cmple(around.maxs) & around.mins.cmple(aabb.maxs);
            if !overlaps.all() {
                return;
            }
            match triangle.scaled_normal().try_normalize() {
                Some(normal) => {
                    let corners = [triangle.a, triangle.b, triangle.c].map(core_vector);
                    found.push((Facet::new(number, corners, core_vector(normal)), vertices));
                }
                None => flat.push(vertices),
            }
        };
        match self.shape.as_typed_shape() {
            TypedShape::TriMesh(mesh) => {
                for number in mesh.bvh().intersect_aabb(&around) {
                    let triangle = mesh.triangle(number);
                    let vertices = [triangle.a, triangle.b, triangle.c].map(place);
                    add(number, &triangle, vertices);
                }
            }
            TypedShape::HeightField(field) => {
                field.map_elements_in_local_aabb(&around, &mut |number, triangle: &Triangle| {
                    let vertices = field.triangle_vids_at_id(number);
                    let vertices = vertices.unwrap_or_default().map(|v| [v, 0, 0]);
                    add(number, triangle, vertices);
                });
            }
            _ => {}
        }
        found.sort_unstable_by_key(|(facet, _)| facet.number);
        let (mut facets, vertices): (Vec<Facet>, Vec<_>) = found.into_iter().unzip();
        join(&mut facets, &vertices, &flat);
        facets
    }
}

/// What two vertices at the same place have in common.
type Place = [u32; 3];

fn place(vertex: Vector) -> Place {
    // Zero has two signs.
    core_vector(vertex).to_array().map(|c| (c + 0.0).to_bits())
}

impl Facet {
    fn new(number: u32, corners: [Vec3; 3], normal: Vec3) -> Self {
        Self {
            number,
            corners,
            normal,
            edges: [Seam::default(); 3],
            is_shared: [false; 3],
            vertices: [Seam::default(); 3],
        }
    }

    pub(crate) fn bounds(&self) -> Aabb {
        let [a, b, c] = self.corners;
        Aabb {
            min: a.min(b).min(c),
            max: a.max(b).max(c),
        }
    }

    /// The smallest of its heights.
    fn width(&self) -> f32 {
        let [a, b, c] = self.corners;
        let longest = (b - a).length().max((c - b).length()).max((a - c).length());
        (b - a).cross(c - a).length() / longest
    }

    /// The angle at a corner.
    fn angle(&self, corner: usize) -> f32 {
        let at = |i: usize| self.corners[i % 3] - self.corners[corner];
        at(corner + 1).angle_between(at(corner + 2))
    }
}

/// An edge by its two ends, the lesser first.
type Ends = (Place, Place);

fn ends(vertices: &[Place; 3], edge: usize) -> Ends {
    let (from, to) = (vertices[edge], vertices[(edge + 1) % 3]);
    (from.min(to), from.max(to))
}

/// Finds out how facets meet, by the places of their vertices. Triangles without an area, in any order,
/// are no facets, but those at their edges meet.
fn join(facets: &mut [Facet], places: &[[Place; 3]], flat: &[[Place; 3]]) {
    let mut same: BTreeMap<Ends, Ends> = BTreeMap::new();
    for vertices in flat {
        let edges = [0, 1, 2].map(|e| ends(vertices, e));
        let edges = edges.map(|e| same.get(&e).copied().unwrap_or(e));
        let first = edges[0].min(edges[1]).min(edges[2]);
        for known in same.values_mut().filter(|known| edges.contains(known)) {
            *known = first;
        }
        same.extend(edges.map(|e| (e, first)));
    }
    let meeting = |e: Ends| same.get(&e).copied().unwrap_or(e);
    let corners = (0..facets.len()).flat_map(|f| [0, 1, 2].map(|c| (places[f][c], f, c)));
    let mut corners: Vec<_> = corners.collect();
    corners.sort_unstable();
    let edges = (0..facets.len()).flat_map(|f| {
        [0, 1, 2].map(|e| {
            let ends = ends(&places[f], e);
            (meeting(ends), f, e, ends)
        })
    });
    let mut edges: Vec<_> = edges.collect();
    edges.sort_unstable();
    for group in edges.chunk_by(|a, b| a.0 == b.0) {
        let normals = group.iter().map(|&(_, f, ..)| (facets[f].normal, 1.0));
        let mut seam = seam(normals);
        seam.is_border = group.len() == 1;
        let widths = group.iter().map(|&(_, f, ..)| facets[f].width());
        seam.width = widths.fold(f32::INFINITY, f32::min);
        seam.is_hollow = group.iter().any(|&(_, f, e, _)| {
            let facet = &facets[f];
            group.iter().any(|&(_, other, of_other, _)| {
                let opposite = facets[other].corners[(of_other + 2) % 3];
                // Of its own corners rounding alone says where they are.
                other != f && (opposite - facet.corners[e]).dot(facet.normal) > 0.0
            })
        });
        for (i, &(_, f, e, ends)) in group.iter().enumerate() {
            facets[f].edges[e] = seam;
            facets[f].is_shared[e] = group[..i].iter().any(|before| before.3 == ends);
        }
    }
    for group in corners.chunk_by(|a, b| a.0 == b.0) {
        let weighted = group
            .iter()
            .map(|&(_, f, c)| (facets[f].normal, facets[f].angle(c)));
        let mut seam = seam(weighted);
        let edges = || {
            group
                .iter()
                .flat_map(|&(_, f, c)| [facets[f].edges[c], facets[f].edges[(c + 2) % 3]])
        };
        seam.is_border = edges().any(|e| e.is_border);
        seam.is_hollow = edges().any(|e| e.is_hollow);
        for &(_, f, c) in group {
            facets[f].vertices[c] = seam;
        }
    }
}

fn seam(normals: impl Iterator<Item = (Vec3, f32)> + Clone) -> Seam {
    let sum: Vec3 = normals.clone().map(|(n, weight)| n * weight).sum();
    let normal = sum.normalize_or_zero();
    let opening = normals.map(|(n, _)| n.dot(normal)).fold(1.0, f32::min);
    Seam {
        normal,
        opening,
        ..Seam::default()
    }
}
