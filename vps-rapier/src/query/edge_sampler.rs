//! The edges of a shape of parry in the voxelmap of a VPS shape. A shape of parry has no pointshell, so
//! samples of its edges stand in for it: shapes smaller than the spacing of the shell's points, such as
//! a small ball, a pin or the corner of a box, are found by them.

use rapier3d::parry::shape::Shape;
use vps_core::{Aabb, DistanceField, Pose3, Trilinear, Vec3};

use super::edges::{EdgeSample, Edges};
use super::pair_contact::PairContact;
use super::sample_id::Elements;
use crate::shape::VpsShape;

/// Largest distance between neighbouring samples, in voxels: the voxelmap shows little that is finer.
const STEP: f32 = 2.0;

/// Width of a triangle, in spacings of the shell's points, from which some of the points meet it.
const MIN_WIDTH: f32 = 2.0;

/// Samples the edges of a shape of parry in the voxelmap of a VPS shape.
pub(crate) struct EdgeSampler<'s> {
    shape: &'s dyn Shape,
    vps: &'s VpsShape,
    field: Trilinear<'s>,
    solid: Aabb,
    /// Additional error of the field beyond the narrow band, in metres.
    far_error: f32,
    /// Largest distance between neighbouring samples, in metres.
    step: f32,
    /// Cosine of half the angle between the normals at the bluntest edge of a surface that is sampled:
    /// such an edge rises between two points of the shell by the error of the voxelmap.
    max_opening: f32,
    /// Width in metres below which triangles may lie between the points of the shell.
    min_width: f32,
    /// Whether the shape of parry is the first of the two.
    is_first: bool,
}

impl<'s> EdgeSampler<'s> {
    pub(crate) fn new(shape: &'s dyn Shape, vps: &'s VpsShape, is_first: bool) -> Self {
        let map = &vps.asset().voxelmap;
        let field = map.trilinear();
        let steepest = 2.0 * field.error_bound() / vps.spacing();
        Self {
            shape,
            vps,
            field,
            max_opening: 1.0 / (1.0 + steepest * steepest).sqrt(),
            min_width: MIN_WIDTH * vps.spacing(),
            solid: map.solid(),
            far_error: map.error_bounds().beyond,
            step: STEP * map.grid().voxel_size(),
            is_first,
        }
    }

    /// Adds the contacts up to `prediction` metres away, `pos12` being the pose of the second shape in
    /// the frame of the first.
    pub(crate) fn contacts(&self, pos12: &Pose3, prediction: f32, found: &mut Vec<PairContact>) {
        let pose = self.to_field(pos12);
        self.for_each_sample(&pose, prediction, &mut |sample| {
            // A point outside of the grid is outside of the solid; a ball around it may not be.
            let exact_from = if sample.radius > 0.0 {
                -prediction
            } else {
                0.0
            };
            found.extend(self.contact(&pose, &sample, prediction, exact_from));
        });
    }

    /// The deepest contact up to `prediction` metres away. Shapes that are apart may seem closer than they
    /// are.
    pub(crate) fn deepest(&self, pos12: &Pose3, prediction: f32) -> Option<PairContact> {
        let pose = self.to_field(pos12);
        let mut deepest: Option<PairContact> = None;
        self.for_each_sample(&pose, prediction, &mut |sample| {
            let threshold = deepest.map_or(-prediction, |d| d.penetration);
            deepest = self.contact(&pose, &sample, -threshold, 0.0).or(deepest);
        });
        deepest
    }

    /// The deepest contact up to `prediction` metres away. Its distance is right also outside of the grid.
    pub(crate) fn closest(&self, pos12: &Pose3, prediction: f32) -> Option<PairContact> {
        let pose = self.to_field(pos12);
        let mut bounds = Vec::new();
        self.for_each_sample(&pose, prediction, &mut |sample| {
            let center = pose.transform_point(sample.center);
            let bound = self.field.penetration(center, Vec3::ZERO) + sample.radius;
            if bound >= -prediction {
                bounds.push((bound, sample));
            }
        });
        bounds.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut closest: Option<PairContact> = None;
        for (bound, sample) in bounds {
            let threshold = closest.map_or(-prediction, |c| c.penetration);
            if bound < threshold {
                break;
            }
            let contact = self.contact(&pose, &sample, -threshold, f32::NEG_INFINITY);
            closest = contact.or(closest);
        }
        closest
    }

    /// The contact of a sample, if it is up to `prediction` metres away. Outside of the grid the field
    /// has a lower bound of the distance alone: where that gives a penetration of at least `exact_from`,
    /// the distance from the surface is computed.
    fn contact(
        &self,
        pose: &Pose3,
        sample: &EdgeSample,
        prediction: f32,
        exact_from: f32,
    ) -> Option<PairContact> {
        let center = pose.transform_point(sample.center);
        let mut at_center = self.field.penetration(center, Vec3::ZERO);
        if at_center + sample.radius < -prediction {
            return None;
        }
        let mut inward = self.field.inward_direction(center);
        if at_center + sample.radius >= exact_from && !self.vps.has_in_grid(center) {
            let on_surface = self.vps.closest_on_surface(center);
            inward = (on_surface - center).normalize_or_zero();
            at_center = -on_surface.distance(center);
        }
        let penetration = at_center + sample.radius;
        if penetration < -prediction {
            return None;
        }
        if inward == Vec3::ZERO {
            inward = (self.solid.center() - center).normalize_or(Vec3::Y);
        }
        let out_of_shape = pose.rotation.inverse() * inward;
        let contact = PairContact {
            points: [
                sample.center + out_of_shape * sample.radius,
                center - inward * at_center,
            ],
            normals: [out_of_shape, -inward],
            shell_normal: None,
            shell_is_first: true,
            ids: sample.id.features(),
            penetration,
        };
        Some(if self.is_first {
            contact
        } else {
            contact.flipped()
        })
    }

    /// Whether a sample is inside of the VPS shape.
    pub(crate) fn touches(&self, pos12: &Pose3) -> bool {
        let pose = self.to_field(pos12);
        let mut touches = false;
        self.for_each_sample(&pose, 0.0, &mut |sample| {
            touches = touches || self.contact(&pose, &sample, 0.0, 0.0).is_some();
        });
        touches
    }

    /// Error bound of the voxelmap anywhere, in metres.
    pub(crate) fn error(&self) -> f32 {
        self.field.error_bound() + self.far_error
    }

    /// Size of the voxels in metres.
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

    /// Calls `visit` with all samples up to `prediction` metres away from the box of the VPS shape.
    fn for_each_sample(&self, pose: &Pose3, prediction: f32, visit: &mut impl FnMut(EdgeSample)) {
        let region = Aabb {
            min: self.solid.min - prediction,
            max: self.solid.max + prediction,
        };
        let edges = Edges {
            pose: *pose,
            region,
            step: self.step,
            max_opening: self.max_opening,
            min_width: self.min_width,
        };
        edges.sample_shape(self.shape, Elements::ALL, 0.0, visit);
    }
}
