//! Samples of the edges of shapes of parry.

use rapier3d::math::{Pose, Real};
use rapier3d::parry::bounding_volume::Aabb as ParryAabb;
use rapier3d::parry::shape::{Cone, Cuboid, Cylinder, Segment, Shape, Triangle, TypedShape};
use vps_core::{Aabb, Pose3, Vec3};

use crate::field::bounds::{clip_segment, rotated_half_extents};
use crate::field::surface::Surface;
use crate::precision::{core_pose, core_real, core_vector, vector};

/// Most points of an edge. Edges longer than that many steps are longer than any voxelmap.
const MAX_EDGE_POINTS: u32 = 1 << 12;

/// Fewest and most points of a circle.
const CIRCLE_POINTS: [u32; 2] = [8, 64];

/// Ids reserved for each element of a shape, of which the points of its edges take one each.
const IDS_PER_ELEMENT: u32 = 1 << 12;

/// A sample of an edge: a ball, or a point if its radius is zero, in the frame of the shape.
#[derive(Clone, Copy)]
pub(crate) struct EdgeSample {
    /// Identifies the sample from step to step.
    pub(crate) id: u32,
    pub(crate) center: Vec3,
    /// In metres.
    pub(crate) radius: f32,
}

/// Samples the edges of a shape within a box.
pub(crate) struct Edges {
    /// From the frame of the shape to the frame of the box.
    pub(crate) pose: Pose3,
    pub(crate) region: Aabb,
    /// Largest distance between neighbouring samples, in metres.
    pub(crate) step: f32,
    /// Opening (a cosine) below which ridges of a surface are sampled.
    pub(crate) max_opening: f32,
    /// Width of a triangle in metres below which all ridges at it are sampled.
    pub(crate) min_width: f32,
}

impl Edges {
    /// Calls `visit` with the samples of a shape. Their ids follow `first`, and their radii are larger
    /// by `radius` than those of the shape itself.
    pub(crate) fn sample_shape(
        &self,
        shape: &dyn Shape,
        first: u32,
        radius: f32,
        visit: &mut impl FnMut(EdgeSample),
    ) {
        let element = |number: u32| first.wrapping_add(number.wrapping_mul(IDS_PER_ELEMENT));
        let rounded = |border: Real| radius + core_real(border);
        match shape.as_typed_shape() {
            TypedShape::Ball(ball) => {
                let zero = Vec3::ZERO;
                self.edge([zero, zero], first, rounded(ball.radius), visit);
            }
            TypedShape::Capsule(capsule) => {
                self.segment(&capsule.segment, first, rounded(capsule.radius), visit);
            }
            TypedShape::Segment(segment) => self.segment(segment, first, radius, visit),
            TypedShape::Triangle(triangle) => self.triangle(triangle, first, radius, visit),
            TypedShape::Cuboid(cuboid) => self.cuboid(cuboid, first, radius, visit),
            TypedShape::Cylinder(cylinder) => self.cylinder(cylinder, first, radius, visit),
            TypedShape::Cone(cone) => self.cone(cone, first, radius, visit),
            TypedShape::ConvexPolyhedron(polyhedron) => {
                let points = polyhedron.points();
                for (number, edge) in (0..).zip(polyhedron.edges()) {
                    let ends = edge.vertices.map(|v| core_vector(points[v as usize]));
                    self.edge(ends, element(number), radius, visit);
                }
            }
            TypedShape::RoundCuboid(round) => {
                self.cuboid(
                    &round.inner_shape,
                    first,
                    rounded(round.border_radius),
                    visit,
                );
            }
            TypedShape::RoundTriangle(round) => {
                let radius = rounded(round.border_radius);
                self.triangle(&round.inner_shape, first, radius, visit);
            }
            TypedShape::RoundCylinder(round) => {
                let radius = rounded(round.border_radius);
                self.cylinder(&round.inner_shape, first, radius, visit);
            }
            TypedShape::RoundCone(round) => {
                let radius = rounded(round.border_radius);
                self.cone(&round.inner_shape, first, radius, visit);
            }
            TypedShape::RoundConvexPolyhedron(round) => {
                let radius = rounded(round.border_radius);
                self.sample_shape(&round.inner_shape, first, radius, visit);
            }
            TypedShape::TriMesh(_) | TypedShape::HeightField(_) => {
                self.surface_edges(shape, &element, radius, visit);
            }
            TypedShape::Polyline(line) => {
                for number in line.bvh().intersect_aabb(&self.local_parry_bounds(radius)) {
                    self.segment(&line.segment(number), element(number), radius, visit);
                }
            }
            TypedShape::Voxels(voxels) => {
                let half = Cuboid::new(voxels.voxel_size() / 2.0);
                for voxel in voxels.voxels_intersecting_local_aabb(&self.local_parry_bounds(radius))
                {
                    if voxel.state.is_empty() {
                        continue;
                    }
                    let at = core_vector(voxels.voxel_center(voxel.grid_coords));
                    let moved = Self {
                        pose: self.pose * Pose3::from_translation(at),
                        ..*self
                    };
                    let mut to_shape = |sample: EdgeSample| {
                        visit(EdgeSample {
                            center: sample.center + at,
                            ..sample
                        });
                    };
                    let [x, y, z] = voxel.grid_coords.to_array().map(|c| c as u32);
                    let number = x.wrapping_add(y << 7).wrapping_add(z << 14);
                    moved.cuboid(&half, element(number), radius, &mut to_shape);
                }
            }
            TypedShape::Compound(compound) => {
                for (number, (pose, part)) in (0..).zip(compound.shapes()) {
                    self.sample_part(&**part, pose, element(number * 37), radius, visit);
                }
            }
            // A half-space has no edges, and those of other custom shapes are unknown.
            TypedShape::HalfSpace(_) | TypedShape::Custom(_) => {}
        }
    }

    /// Samples the edges of a surface that the points of a shell may miss: ridges and borders. Flat and
    /// concave edges are left out.
    fn surface_edges(
        &self,
        shape: &dyn Shape,
        element: &impl Fn(u32) -> u32,
        radius: f32,
        visit: &mut impl FnMut(EdgeSample),
    ) {
        let Some(surface) = Surface::of(shape) else {
            return;
        };
        // No point of the shell is near a surface that lies in the solid as a whole.
        let min_width = if self.region.may_contain(&surface.bounds(), &self.pose) {
            f32::INFINITY
        } else {
            self.min_width
        };
        for facet in surface.facets_in(&self.local_bounds(radius)) {
            for (number, edge) in (0_u8..).zip(&facet.edges) {
                let i = usize::from(number);
                if facet.is_shared[i] || !edge.may_be_missed(self.max_opening, min_width) {
                    continue;
                }
                let ends = [facet.corners[i], facet.corners[(i + 1) % 3]];
                let first = element(facet.number).wrapping_add(u32::from(number) << 10);
                self.edge(ends, first, radius, visit);
            }
        }
    }

    fn sample_part(
        &self,
        part: &dyn Shape,
        pose: &Pose,
        first: u32,
        radius: f32,
        visit: &mut impl FnMut(EdgeSample),
    ) {
        let pose = core_pose(pose);
        let moved = Self {
            pose: self.pose * pose,
            ..*self
        };
        // A trait object ends the recursion of closure types for parts of parts.
        let mut to_shape = |sample: EdgeSample| {
            visit(EdgeSample {
                center: pose.transform_point(sample.center),
                ..sample
            });
        };
        moved.sample_shape(
            part,
            first,
            radius,
            &mut (&mut to_shape as &mut dyn FnMut(EdgeSample)),
        );
    }

    /// The same as a box of parry.
    fn local_parry_bounds(&self, radius: f32) -> ParryAabb {
        let region = self.local_bounds(radius);
        ParryAabb::new(vector(region.min), vector(region.max))
    }

    /// A box in the frame of the shape that encloses the region, enlarged by `radius`.
    fn local_bounds(&self, radius: f32) -> Aabb {
        let inverse = self.pose.inverse();
        let half = 0.5 * self.region.extents() + radius;
        let center = inverse.transform_point(self.region.center());
        let reach = rotated_half_extents(&inverse, half);
        Aabb {
            min: center - reach,
            max: center + reach,
        }
    }

    fn segment(
        &self,
        segment: &Segment,
        first: u32,
        radius: f32,
        visit: &mut impl FnMut(EdgeSample),
    ) {
        self.edge(
            [segment.a, segment.b].map(core_vector),
            first,
            radius,
            visit,
        );
    }

    fn triangle(
        &self,
        triangle: &Triangle,
        first: u32,
        radius: f32,
        visit: &mut impl FnMut(EdgeSample),
    ) {
        let [a, b, c] = [triangle.a, triangle.b, triangle.c].map(core_vector);
        for (number, ends) in (0..).zip([[a, b], [b, c], [c, a]]) {
            self.edge(ends, first.wrapping_add(number << 10), radius, visit);
        }
    }

    fn cuboid(&self, cuboid: &Cuboid, first: u32, radius: f32, visit: &mut impl FnMut(EdgeSample)) {
        let half = core_vector(cuboid.half_extents);
        let corner = |i: u32| {
            let side = |axis: u32| if i >> axis & 1 == 1 { 1.0 } else { -1.0 };
            half * Vec3::new(side(0), side(1), side(2))
        };
        // A shape that stands on a face is near none of the edges.
        let region = self.local_bounds(radius);
        let mut number = 0;
        for axis in 0..3 {
            for low in (0..8).filter(|i| i >> axis & 1 == 0) {
                let [min, max] = [corner(low), corner(low | 1 << axis)];
                if min.cmple(region.max).all() && max.cmpge(region.min).all() {
                    self.edge([min, max], first.wrapping_add(number << 12), radius, visit);
                }
                number += 1;
            }
        }
    }

    fn cylinder(
        &self,
        cylinder: &Cylinder,
        first: u32,
        radius: f32,
        visit: &mut impl FnMut(EdgeSample),
    ) {
        let half_height = core_real(cylinder.half_height) * Vec3::Y;
        self.circle(cylinder.radius, |number, out| {
            let ends = [out - half_height, out + half_height];
            self.edge(ends, first.wrapping_add(number << 12), radius, visit);
        });
    }

    fn cone(&self, cone: &Cone, first: u32, radius: f32, visit: &mut impl FnMut(EdgeSample)) {
        let half_height = core_real(cone.half_height) * Vec3::Y;
        self.circle(cone.radius, |number, out| {
            let ends = [out - half_height, half_height];
            self.edge(ends, first.wrapping_add(number << 12), radius, visit);
        });
    }

    /// Points of a circle about y, no further apart than a step, as far as the number of points allows.
    fn circle(&self, radius: Real, mut visit: impl FnMut(u32, Vec3)) {
        let radius = core_real(radius);
        let length = std::f32::consts::TAU * radius;
        let count = ((length / self.step).ceil() as u32).clamp(CIRCLE_POINTS[0], CIRCLE_POINTS[1]);
        for number in 0..count {
            let (sin, cos) = (std::f32::consts::TAU * number as f32 / count as f32).sin_cos();
            visit(number, radius * Vec3::new(cos, 0.0, sin));
        }
    }

    /// Samples the edge between two ends, no further apart than a step.
    fn edge(&self, [a, b]: [Vec3; 2], first: u32, radius: f32, visit: &mut impl FnMut(EdgeSample)) {
        let [start, end] = [a, b].map(|p| self.pose.transform_point(p));
        let region = Aabb {
            min: self.region.min - radius,
            max: self.region.max + radius,
        };
        let Some([enter, leave]) = clip_segment(start, end - start, &region) else {
            return;
        };
        let steps = ((b - a).length() / self.step).ceil().max(1.0);
        let steps = steps.min(MAX_EDGE_POINTS as f32);
        let steps = if a == b { 0.0 } else { steps };
        // The samples of an edge are the same whichever part of it is near.
        let (from, to) = (
            (enter * steps).ceil() as u32,
            (leave * steps).floor() as u32,
        );
        for i in from..=to {
            let t = i as f32 / steps.max(1.0);
            // Feature ids have 30 bits.
            let id = first.wrapping_add(i) & 0x3fff_ffff;
            visit(EdgeSample {
                id,
                center: a + (b - a) * t,
                radius,
            });
        }
    }
}
