//! Samples of the edges of shapes of parry.

use rapier3d::math::{Pose, Real};
use rapier3d::parry::bounding_volume::Aabb as ParryAabb;
use rapier3d::parry::shape::{Cone, Cuboid, Cylinder, Segment, Shape, Triangle, TypedShape};
use vps_core::{Aabb, Pose3, Vec3};

use super::sample_id::{EdgeId, Element, Elements, MAX_EDGE, MAX_SAMPLE, SampleId};
use crate::field::bounds::{clip_segment, rotated_half_extents};
use crate::field::surface::Surface;
use crate::precision::{core_pose, core_real, core_vector, vector};

/// Most steps along an edge. Edges longer than that many steps are longer than any voxelmap.
const MAX_STEPS: u32 = 1 << 12;

/// Fewest and most points of a circle.
const CIRCLE_POINTS: [u32; 2] = [8, 64];

const _: () = assert!(MAX_STEPS <= MAX_SAMPLE && CIRCLE_POINTS[1] - 1 <= MAX_EDGE);

/// A sample of an edge: a ball, or a point if its radius is zero, in the frame of the shape.
#[derive(Clone, Copy)]
pub(crate) struct EdgeSample {
    /// Identifies the sample from step to step.
    pub(crate) id: SampleId,
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
    /// Calls `visit` with the samples of a shape, whose elements are `elements`. Their radii are larger
    /// by `radius` than those of the shape itself.
    pub(crate) fn sample_shape(
        &self,
        shape: &dyn Shape,
        elements: Elements,
        radius: f32,
        visit: &mut impl FnMut(EdgeSample),
    ) {
        let only = elements.element(0);
        let rounded = |border: Real| radius + core_real(border);
        match shape.as_typed_shape() {
            TypedShape::Ball(ball) => {
                let zero = Vec3::ZERO;
                self.edge([zero, zero], only.edge(0), rounded(ball.radius), visit);
            }
            TypedShape::Capsule(capsule) => {
                self.segment(
                    &capsule.segment,
                    only.edge(0),
                    rounded(capsule.radius),
                    visit,
                );
            }
            TypedShape::Segment(segment) => self.segment(segment, only.edge(0), radius, visit),
            TypedShape::Triangle(triangle) => self.triangle(triangle, only, radius, visit),
            TypedShape::Cuboid(cuboid) => self.cuboid(cuboid, only, radius, visit),
            TypedShape::Cylinder(cylinder) => self.cylinder(cylinder, only, radius, visit),
            TypedShape::Cone(cone) => self.cone(cone, only, radius, visit),
            TypedShape::ConvexPolyhedron(polyhedron) => {
                let points = polyhedron.points();
                for (number, edge) in (0..).zip(polyhedron.edges()) {
                    let ends = edge.vertices.map(|v| core_vector(points[v as usize]));
                    self.edge(ends, elements.element(number).edge(0), radius, visit);
                }
            }
            TypedShape::RoundCuboid(round) => {
                let radius = rounded(round.border_radius);
                self.cuboid(&round.inner_shape, only, radius, visit);
            }
            TypedShape::RoundTriangle(round) => {
                let radius = rounded(round.border_radius);
                self.triangle(&round.inner_shape, only, radius, visit);
            }
            TypedShape::RoundCylinder(round) => {
                let radius = rounded(round.border_radius);
                self.cylinder(&round.inner_shape, only, radius, visit);
            }
            TypedShape::RoundCone(round) => {
                let radius = rounded(round.border_radius);
                self.cone(&round.inner_shape, only, radius, visit);
            }
            TypedShape::RoundConvexPolyhedron(round) => {
                let radius = rounded(round.border_radius);
                self.sample_shape(&round.inner_shape, elements, radius, visit);
            }
            TypedShape::TriMesh(_) | TypedShape::HeightField(_) => {
                self.surface_edges(shape, elements, radius, visit);
            }
            TypedShape::Polyline(line) => {
                for number in line.bvh().intersect_aabb(&self.local_parry_bounds(radius)) {
                    let id = elements.element(number.into()).edge(0);
                    self.segment(&line.segment(number), id, radius, visit);
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
                    let element = elements.voxel(voxel.grid_coords.to_array().map(|c| c as u64));
                    moved.cuboid(&half, element, radius, &mut to_shape);
                }
            }
            TypedShape::Compound(compound) => {
                let parts = compound.shapes();
                for (number, (pose, part)) in parts.iter().enumerate() {
                    let elements = elements.of_part(number, parts.len());
                    self.sample_part(&**part, pose, elements, radius, visit);
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
        elements: Elements,
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
                let element = elements.element(facet.number.into());
                self.edge(ends, element.edge(number.into()), radius, visit);
            }
        }
    }

    fn sample_part(
        &self,
        part: &dyn Shape,
        pose: &Pose,
        elements: Elements,
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
            elements,
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
        id: EdgeId,
        radius: f32,
        visit: &mut impl FnMut(EdgeSample),
    ) {
        self.edge([segment.a, segment.b].map(core_vector), id, radius, visit);
    }

    fn triangle(
        &self,
        triangle: &Triangle,
        element: Element,
        radius: f32,
        visit: &mut impl FnMut(EdgeSample),
    ) {
        let [a, b, c] = [triangle.a, triangle.b, triangle.c].map(core_vector);
        for (number, ends) in (0..).zip([[a, b], [b, c], [c, a]]) {
            self.edge(ends, element.edge(number), radius, visit);
        }
    }

    fn cuboid(
        &self,
        cuboid: &Cuboid,
        element: Element,
        radius: f32,
        visit: &mut impl FnMut(EdgeSample),
    ) {
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
                    self.edge([min, max], element.edge(number), radius, visit);
                }
                number += 1;
            }
        }
    }

    fn cylinder(
        &self,
        cylinder: &Cylinder,
        element: Element,
        radius: f32,
        visit: &mut impl FnMut(EdgeSample),
    ) {
        let half_height = core_real(cylinder.half_height) * Vec3::Y;
        self.circle(cylinder.radius, |number, out| {
            let ends = [out - half_height, out + half_height];
            self.edge(ends, element.edge(number), radius, visit);
        });
    }

    fn cone(&self, cone: &Cone, element: Element, radius: f32, visit: &mut impl FnMut(EdgeSample)) {
        let half_height = core_real(cone.half_height) * Vec3::Y;
        self.circle(cone.radius, |number, out| {
            let ends = [out - half_height, half_height];
            self.edge(ends, element.edge(number), radius, visit);
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
    fn edge(&self, [a, b]: [Vec3; 2], id: EdgeId, radius: f32, visit: &mut impl FnMut(EdgeSample)) {
        let [start, end] = [a, b].map(|p| self.pose.transform_point(p));
        let region = Aabb {
            min: self.region.min - radius,
            max: self.region.max + radius,
        };
        let Some([enter, leave]) = clip_segment(start, end - start, &region) else {
            return;
        };
        let steps = ((b - a).length() / self.step).ceil().max(1.0);
        let steps = steps.min(MAX_STEPS as f32);
        let steps = if a == b { 0.0 } else { steps };
        // The samples of an edge are the same whichever part of it is near.
        let (from, to) = (
            (enter * steps).ceil() as u32,
            (leave * steps).floor() as u32,
        );
        for i in from..=to {
            let t = i as f32 / steps.max(1.0);
            visit(EdgeSample {
                id: id.sample(i),
                center: a + (b - a) * t,
                radius,
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use proptest::prelude::*;
    use rapier3d::math::{IVector, Vector};
    use rapier3d::parry::shape::{PackedFeatureId, SharedShape};
    use rapier3d::parry::utils::Array2;

    use super::*;

    /// The samples of a shape within a cube of half extent `reach` metres around `center`, by their ids.
    /// Panics if two have the same.
    fn samples(
        shape: &SharedShape,
        center: Vec3,
        reach: f32,
        step: f32,
    ) -> HashMap<[PackedFeatureId; 2], Vec3> {
        let edges = Edges {
            pose: Pose3::IDENTITY,
            region: Aabb {
                min: center - reach,
                max: center + reach,
            },
            step,
            max_opening: 1.0,
            min_width: f32::INFINITY,
        };
        let mut found = HashMap::new();
        edges.sample_shape(&**shape, Elements::ALL, 0.0, &mut |sample| {
            let ids = sample.id.features();
            if let Some(other) = found.insert(ids, sample.center) {
                panic!("{ids:?} is at {other} and at {}", sample.center);
            }
        });
        found
    }

    // Coordinates of rapier's voxels have 32 or 64 bits.
    #[allow(clippy::useless_conversion)]
    fn ivector([x, y, z]: [i32; 3]) -> IVector {
        IVector::new(x.into(), y.into(), z.into())
    }

    /// A cone with more edges than a convex polyhedron usually has.
    fn hull(corners: u32) -> SharedShape {
        let ring = (0..corners).map(|i| {
            let (sin, cos) = (std::f32::consts::TAU * i as f32 / corners as f32).sin_cos();
            vector(Vec3::new(cos, 0.0, sin))
        });
        let points: Vec<_> = ring.chain([vector(Vec3::Y)]).collect();
        SharedShape::convex_hull(&points).unwrap()
    }

    #[test]
    fn samples_of_long_edges_have_ids_of_their_own() {
        let shapes = [
            SharedShape::cuboid(1.0, 1.0, 1.0),
            SharedShape::cylinder(1.0, 1.0),
            SharedShape::cone(1.0, 1.0),
            SharedShape::capsule_y(1.0, 0.1),
            SharedShape::triangle(Vector::ZERO, Vector::X, Vector::Y),
            hull(100),
        ];
        for shape in &shapes {
            // More steps than an edge may have.
            let found = samples(shape, Vec3::ZERO, 3.0, 1e-4);
            assert!(found.len() > MAX_STEPS as usize, "{:?}", shape.shape_type());
        }
        let (vertices, triangles) = shapes[0].as_cuboid().unwrap().to_trimesh();
        let mesh = SharedShape::trimesh(vertices, triangles).unwrap();
        let found = samples(&mesh, Vec3::ZERO, 3.0, 1e-4);
        assert!(found.len() > 12 * MAX_STEPS as usize);
    }

    #[test]
    fn samples_of_all_parts_of_a_compound_have_ids_of_their_own() {
        let heights = SharedShape::heightfield(
            Array2::new(4, 4, (0..16_u8).map(|i| Real::from(i % 3)).collect()),
            Vector::ONE,
        );
        let grid: Vec<_> = (0..5).map(|i| ivector([i, -i, i * i])).collect();
        let voxels = SharedShape::voxels(Vector::splat(0.1), &grid);
        let parts = [
            hull(100),
            heights,
            voxels,
            SharedShape::cylinder(0.5, 0.5),
            SharedShape::ball(0.5),
        ];
        let placed = (0..60).map(|i: u8| {
            let place = Pose::from_translation(Vector::X * Real::from(i));
            (place, parts[usize::from(i) % parts.len()].clone())
        });
        let compound = SharedShape::compound(placed.collect());
        let found = samples(&compound, Vec3::ZERO, 100.0, 0.1);
        let alone = parts
            .iter()
            .map(|part| samples(part, Vec3::ZERO, 100.0, 0.1).len());
        assert_eq!(found.len(), 12 * alone.sum::<usize>());
    }

    proptest! {
        /// Voxels anywhere in a grid, among them those as far apart as ids tell and those of which the
        /// last bits of a coordinate are the same.
        #[test]
        fn samples_of_near_voxels_have_ids_of_their_own(
            first in prop::array::uniform3(-1_000_000..1_000_000_i32),
            others in prop::collection::vec(
                prop::array::uniform3(prop_oneof![
                    -2..3_i32,
                    Just(127), Just(128), Just(1 << 12), Just((1 << 13) - 1),
                ]),
                1..30,
            ),
            steps in 1_u16..40,
        ) {
            let first = ivector(first);
            let mut grid: Vec<_> = others.into_iter().map(|o| first + ivector(o)).collect();
            grid.retain(|c| (*c - first).min_element() >= 0);
            grid.push(first);
            grid.sort_by_key(|c| c.to_array());
            grid.dedup();
            let voxels = SharedShape::voxels(Vector::ONE, &grid);
            let center = core_vector(voxels.compute_local_aabb().center());
            let found = samples(&voxels, center, 1e4, 1.0 / (f32::from(steps) - 0.5));
            prop_assert_eq!(found.len(), grid.len() * 12 * (usize::from(steps) + 1));
        }

        /// Numbers up to the limits of [`SampleId::features`].
        #[test]
        fn ids_of_all_elements_differ(
            a in (0..1_u64 << 41, 0..=MAX_EDGE, 0..=MAX_SAMPLE),
            b in (0..1_u64 << 41, 0..=MAX_EDGE, 0..=MAX_SAMPLE),
            bit in 0..41_u32,
        ) {
            let ids = |(element, edge, sample)| {
                Elements::ALL.element(element).edge(edge).sample(sample).features()
            };
            prop_assert_eq!(ids(a) == ids(b), a == b);
            // Of one bit, too, and through the parts of a compound.
            prop_assert_ne!(ids(a), ids((a.0 ^ 1 << bit, a.1, a.2)));
            let part = |i: usize, element| Elements::ALL.of_part(i, 3).element(element).edge(a.1);
            prop_assert_ne!(
                part(0, a.0 / 3).sample(a.2).features(),
                part(1, b.0 / 3).sample(a.2).features()
            );
        }
    }
}
