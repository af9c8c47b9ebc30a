//! The other way round for a shape of parry, which has no pointshell: points of its edges in the
//! voxelmap of the VPS shape. What is smaller than the spacing of the shell's points, a ball, a pin
//! or the corner of a box, is not missed by both.

use rapier3d::math::{Pose, Real};
use rapier3d::parry::bounding_volume::Aabb as ParryAabb;
use rapier3d::parry::shape::{
    Cone, Cuboid, Cylinder, PackedFeatureId, Segment, Shape, Triangle, TypedShape,
};
use vps_core::{Aabb, DistanceField, Pose3, Trilinear, Vec3};

use crate::VpsShape;
use crate::contact::PairContact;
use crate::real::{core_pose, core_real, core_vector, vector};
use crate::surface::Surface;

/// How many voxels two neighbouring points of an edge are apart at the most: the voxelmap shows
/// little that is finer.
const STEP: f32 = 2.0;

/// Most points of an edge; edges longer than all their steps are longer than any voxelmap.
const MOST_POINTS: u32 = 1 << 12;

/// How many spacings of the shell's points a triangle must be wide for some of them to meet it.
const NARROW: f32 = 2.0;

/// How many points of a circle there are.
const CIRCLE: [u32; 2] = [8, 64];

/// A shape of parry in the voxelmap of a VPS shape.
pub(crate) struct Probe<'s> {
    shape: &'s dyn Shape,
    vps: &'s VpsShape,
    field: Trilinear<'s>,
    solid: Aabb,
    /// What the error of the field may be more far from the surface, in metres.
    far_error: f32,
    /// Metres between points.
    step: f32,
    /// The cosine of half the angle between the normals at an edge of a surface that is just sharp
    /// enough: between two points of the shell it stands out by what the voxelmap may be off.
    bluntest: f32,
    /// How wide triangles must be in metres for the points of the shell to meet them all.
    narrowest: f32,
    /// Whether the shape of parry is the first of the two.
    is_first: bool,
}

/// A ball, or a point if its radius is zero, in the frame of the probe.
#[derive(Clone, Copy)]
struct Tip {
    id: u32,
    center: Vec3,
    radius: f32,
}

impl<'s> Probe<'s> {
    pub(crate) fn new(shape: &'s dyn Shape, vps: &'s VpsShape, is_first: bool) -> Self {
        let map = &vps.asset().voxelmap;
        let field = map.trilinear();
        let steepest = 2.0 * field.error_bound() / vps.spacing();
        Self {
            shape,
            vps,
            field,
            bluntest: 1.0 / (1.0 + steepest * steepest).sqrt(),
            narrowest: NARROW * vps.spacing(),
            solid: map.solid(),
            far_error: map.accuracy().far_m,
            step: STEP * map.grid().voxel_size(),
            is_first,
        }
    }

    /// Adds the contacts up to `margin` metres away, `pos12` being the pose of the second shape in
    /// the frame of the first.
    pub(crate) fn contacts(&self, pos12: &Pose3, margin: f32, found: &mut Vec<PairContact>) {
        let pose = self.to_field(pos12);
        self.for_each_tip(&pose, margin, &mut |tip| {
            // A point outside of the grid is outside of the solid; a ball around it may not be.
            let exact_from = if tip.radius > 0.0 { -margin } else { 0.0 };
            found.extend(self.contact(&pose, &tip, margin, exact_from));
        });
    }

    /// The deepest contact up to `margin` metres away; apart from each other, the shapes may seem closer
    /// than they are.
    pub(crate) fn deepest(&self, pos12: &Pose3, margin: f32) -> Option<PairContact> {
        let pose = self.to_field(pos12);
        let mut deepest: Option<PairContact> = None;
        self.for_each_tip(&pose, margin, &mut |tip| {
            let least = deepest.map_or(-margin, |d| d.penetration);
            deepest = self.contact(&pose, &tip, -least, 0.0).or(deepest);
        });
        deepest
    }

    /// The deepest contact up to `margin` metres away, at its distance also from outside of the grid.
    pub(crate) fn closest(&self, pos12: &Pose3, margin: f32) -> Option<PairContact> {
        let pose = self.to_field(pos12);
        let mut bounds = Vec::new();
        self.for_each_tip(&pose, margin, &mut |tip| {
            let center = pose.transform_point(tip.center);
            let bound = self.field.penetration(center, Vec3::ZERO) + tip.radius;
            if bound >= -margin {
                bounds.push((bound, tip));
            }
        });
        bounds.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut closest: Option<PairContact> = None;
        for (bound, tip) in bounds {
            let least = closest.map_or(-margin, |c| c.penetration);
            if bound < least {
                break;
            }
            let contact = self.contact(&pose, &tip, -least, f32::NEG_INFINITY);
            closest = contact.or(closest);
        }
        closest
    }

    /// The contact at a tip, if it is up to `margin` metres away. Outside of the grid the field has a
    /// lower bound of the distance alone: where that says that it is as deep as `exact_from`, or deeper,
    /// the distance is taken.
    fn contact(
        &self,
        pose: &Pose3,
        tip: &Tip,
        margin: f32,
        exact_from: f32,
    ) -> Option<PairContact> {
        let center = pose.transform_point(tip.center);
        let mut at_center = self.field.penetration(center, Vec3::ZERO);
        if at_center + tip.radius < -margin {
            return None;
        }
        let mut inward = self.field.inward_direction(center);
        if at_center + tip.radius >= exact_from && !self.vps.has_in_grid(center) {
            let on_surface = self.vps.closest_on_surface(center);
            inward = (on_surface - center).normalize_or_zero();
            at_center = -on_surface.distance(center);
        }
        let penetration = at_center + tip.radius;
        if penetration < -margin {
            return None;
        }
        if inward == Vec3::ZERO {
            inward = (self.solid.center() - center).normalize_or(Vec3::Y);
        }
        let out_of_probe = pose.rotation.inverse() * inward;
        let contact = PairContact {
            points: [
                tip.center + out_of_probe * tip.radius,
                center - inward * at_center,
            ],
            normals: [out_of_probe, -inward],
            by_shell: None,
            shell_is_first: true,
            ids: [PackedFeatureId::edge(tip.id), PackedFeatureId::UNKNOWN],
            penetration,
        };
        Some(if self.is_first {
            contact
        } else {
            contact.flipped()
        })
    }

    /// Whether a point of an edge is inside of the VPS shape.
    pub(crate) fn touches(&self, pos12: &Pose3) -> bool {
        let pose = self.to_field(pos12);
        let mut touches = false;
        self.for_each_tip(&pose, 0.0, &mut |tip| {
            touches = touches || self.contact(&pose, &tip, 0.0, 0.0).is_some();
        });
        touches
    }

    /// How far what the voxelmap says may be off anywhere in metres.
    pub(crate) fn error(&self) -> f32 {
        self.field.error_bound() + self.far_error
    }

    /// The size of the voxels in metres.
    pub(crate) fn resolution(&self) -> f32 {
        self.field.voxel_size()
    }

    fn to_field(&self, pos12: &Pose3) -> Pose3 {
        if self.is_first {
            pos12.inverse()
        } else {
            *pos12
        }
    }

    /// Calls `visit` with all points of edges up to `margin` metres away from the box of the VPS
    /// shape.
    fn for_each_tip(&self, pose: &Pose3, margin: f32, visit: &mut impl FnMut(Tip)) {
        let around = Aabb {
            min: self.solid.min - margin,
            max: self.solid.max + margin,
        };
        let edges = Edges {
            pose: *pose,
            around,
            step: self.step,
            bluntest: self.bluntest,
            narrowest: self.narrowest,
        };
        edges.of_shape(self.shape, 0, 0.0, visit);
    }
}

/// Cuts edges into points, and leaves out those outside of a box.
struct Edges {
    /// To the frame of the box.
    pose: Pose3,
    around: Aabb,
    step: f32,
    /// Those of [`Probe`].
    bluntest: f32,
    narrowest: f32,
}

/// What the number of an element of a shape is multiplied with: points of its edges follow.
const POINTS_OF_ELEMENT: u32 = 1 << 12;

impl Edges {
    fn of_shape(&self, shape: &dyn Shape, first: u32, radius: f32, visit: &mut impl FnMut(Tip)) {
        let element = |number: u32| first.wrapping_add(number.wrapping_mul(POINTS_OF_ELEMENT));
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
                self.of_shape(&round.inner_shape, first, radius, visit);
            }
            TypedShape::TriMesh(_) | TypedShape::HeightField(_) => {
                self.sharp_edges(shape, &element, radius, visit);
            }
            TypedShape::Polyline(line) => {
                for number in line.bvh().intersect_aabb(&self.local_box(radius)) {
                    self.segment(&line.segment(number), element(number), radius, visit);
                }
            }
            TypedShape::Voxels(voxels) => {
                let half = Cuboid::new(voxels.voxel_size() / 2.0);
                for voxel in voxels.voxels_intersecting_local_aabb(&self.local_box(radius)) {
                    if voxel.state.is_empty() {
                        continue;
                    }
                    let at = core_vector(voxels.voxel_center(voxel.grid_coords));
                    let moved = Self {
                        pose: self.pose * Pose3::from_translation(at),
                        ..*self
                    };
                    let mut back = |tip: Tip| {
                        visit(Tip {
                            center: tip.center + at,
                            ..tip
                        });
                    };
                    let [x, y, z] = voxel.grid_coords.to_array().map(|c| c as u32);
                    let number = x.wrapping_add(y << 7).wrapping_add(z << 14);
                    moved.cuboid(&half, element(number), radius, &mut back);
                }
            }
            TypedShape::Compound(compound) => {
                for (number, (pose, part)) in (0..).zip(compound.shapes()) {
                    self.of_part(&**part, pose, element(number * 37), radius, visit);
                }
            }
            // A half-space has no edges; a custom shape that is none of ours, none that are known.
            TypedShape::HalfSpace(_) | TypedShape::Custom(_) => {}
        }
    }

    /// The edges of a surface that stand out between the points of a shell. Flat and hollow ones have
    /// nothing to say.
    fn sharp_edges(
        &self,
        shape: &dyn Shape,
        element: &impl Fn(u32) -> u32,
        radius: f32,
        visit: &mut impl FnMut(Tip),
    ) {
        let Some(surface) = Surface::of(shape) else {
            return;
        };
        // Of what lies in the solid as a whole no point of the shell is near.
        let narrowest = if self.around.may_hold(&surface.bounds(), &self.pose) {
            f32::INFINITY
        } else {
            self.narrowest
        };
        for facet in surface.facets_in(&self.local_bounds(radius)) {
            for (number, seam) in (0_u8..).zip(&facet.edges) {
                let i = usize::from(number);
                if facet.is_shared[i] || !seam.stands_out(self.bluntest, narrowest) {
                    continue;
                }
                let ends = [facet.corners[i], facet.corners[(i + 1) % 3]];
                let first = element(facet.number).wrapping_add(u32::from(number) << 10);
                self.edge(ends, first, radius, visit);
            }
        }
    }

    fn of_part(
        &self,
        part: &dyn Shape,
        pose: &Pose,
        first: u32,
        radius: f32,
        visit: &mut impl FnMut(Tip),
    ) {
        let pose = core_pose(pose);
        let moved = Self {
            pose: self.pose * pose,
            ..*self
        };
        // Behind a pointer, since a part of a part would be of another type each time.
        let mut back = |tip: Tip| {
            visit(Tip {
                center: pose.transform_point(tip.center),
                ..tip
            });
        };
        moved.of_shape(part, first, radius, &mut (&mut back as &mut dyn FnMut(Tip)));
    }

    /// What holds the box, in the frame of the shape, as parry has it.
    fn local_box(&self, radius: f32) -> ParryAabb {
        let around = self.local_bounds(radius);
        ParryAabb::new(vector(around.min), vector(around.max))
    }

    /// What holds the box, in the frame of the shape.
    fn local_bounds(&self, radius: f32) -> Aabb {
        let inverse = self.pose.inverse();
        let half = 0.5 * self.around.extents() + radius;
        let center = inverse.transform_point(self.around.center());
        let axes = unsigned_axes(&inverse);
        let reach = axes[0] * half.x + axes[1] * half.y + axes[2] * half.z;
        Aabb {
            min: center - reach,
            max: center + reach,
        }
    }

    fn segment(&self, segment: &Segment, first: u32, radius: f32, visit: &mut impl FnMut(Tip)) {
        self.edge(
            [segment.a, segment.b].map(core_vector),
            first,
            radius,
            visit,
        );
    }

    fn triangle(&self, triangle: &Triangle, first: u32, radius: f32, visit: &mut impl FnMut(Tip)) {
        let [a, b, c] = [triangle.a, triangle.b, triangle.c].map(core_vector);
        for (number, ends) in (0..).zip([[a, b], [b, c], [c, a]]) {
            self.edge(ends, first.wrapping_add(number << 10), radius, visit);
        }
    }

    fn cuboid(&self, cuboid: &Cuboid, first: u32, radius: f32, visit: &mut impl FnMut(Tip)) {
        let half = core_vector(cuboid.half_extents);
        let corner = |i: u32| {
            let side = |axis: u32| if i >> axis & 1 == 1 { 1.0 } else { -1.0 };
            half * Vec3::new(side(0), side(1), side(2))
        };
        // What stands on a face is near none of them.
        let around = self.local_bounds(radius);
        let mut number = 0;
        for axis in 0..3 {
            for low in (0..8).filter(|i| i >> axis & 1 == 0) {
                let [min, max] = [corner(low), corner(low | 1 << axis)];
                if min.cmple(around.max).all() && max.cmpge(around.min).all() {
                    self.edge([min, max], first.wrapping_add(number << 12), radius, visit);
                }
                number += 1;
            }
        }
    }

    fn cylinder(&self, cylinder: &Cylinder, first: u32, radius: f32, visit: &mut impl FnMut(Tip)) {
        let half_height = core_real(cylinder.half_height) * Vec3::Y;
        self.circle(cylinder.radius, |number, out| {
            let ends = [out - half_height, out + half_height];
            self.edge(ends, first.wrapping_add(number << 12), radius, visit);
        });
    }

    fn cone(&self, cone: &Cone, first: u32, radius: f32, visit: &mut impl FnMut(Tip)) {
        let half_height = core_real(cone.half_height) * Vec3::Y;
        self.circle(cone.radius, |number, out| {
            let ends = [out - half_height, half_height];
            self.edge(ends, first.wrapping_add(number << 12), radius, visit);
        });
    }

    /// Points of a circle about y, no further apart than a step if that takes no more than the most.
    fn circle(&self, radius: Real, mut visit: impl FnMut(u32, Vec3)) {
        let radius = core_real(radius);
        let length = std::f32::consts::TAU * radius;
        let count = ((length / self.step).ceil() as u32).clamp(CIRCLE[0], CIRCLE[1]);
        for number in 0..count {
            let (sin, cos) = (std::f32::consts::TAU * number as f32 / count as f32).sin_cos();
            visit(number, radius * Vec3::new(cos, 0.0, sin));
        }
    }

    /// Points of the edge between two ends, no further apart than a step.
    fn edge(&self, [a, b]: [Vec3; 2], first: u32, radius: f32, visit: &mut impl FnMut(Tip)) {
        let [start, end] = [a, b].map(|p| self.pose.transform_point(p));
        let Some([enter, leave]) = self.within(start, end - start, radius) else {
            return;
        };
        let steps = ((b - a).length() / self.step).ceil().max(1.0);
        let steps = steps.min(MOST_POINTS as f32);
        let steps = if a == b { 0.0 } else { steps };
        // Always the same points of an edge, whatever of it is near.
        let (from, to) = (
            (enter * steps).ceil() as u32,
            (leave * steps).floor() as u32,
        );
        for i in from..=to {
            let t = i as f32 / steps.max(1.0);
            // Feature ids have 30 bits.
            let id = first.wrapping_add(i) & 0x3fff_ffff;
            visit(Tip {
                id,
                center: a + (b - a) * t,
                radius,
            });
        }
    }

    /// From where to where, 0 to 1, a way leads through the box made larger by `radius`.
    fn within(&self, start: Vec3, way: Vec3, radius: f32) -> Option<[f32; 2]> {
        let (low, high) = (self.around.min - radius, self.around.max + radius);
        let (mut enter, mut leave) = (0.0_f32, 1.0_f32);
        for axis in 0..3 {
            let (s, w) = (start[axis], way[axis]);
            if w == 0.0 {
                if s < low[axis] || s > high[axis] {
                    return None;
                }
                continue;
            }
            let (one, other) = ((low[axis] - s) / w, (high[axis] - s) / w);
            enter = enter.max(one.min(other));
            leave = leave.min(one.max(other));
        }
        (enter <= leave).then_some([enter, leave])
    }
}

/// The axes of a rotation, without signs.
fn unsigned_axes(pose: &Pose3) -> [Vec3; 3] {
    [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| (pose.rotation * axis).abs())
}
