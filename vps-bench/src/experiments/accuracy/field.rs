//! Voxelmaps at points of known penetration.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rapier3d::glamx::DVec3;
use vps_build::{BuildOptions, Mesh, PointCount, Resolution};
use vps_core::{DistanceField, PointSphereTree, Pose3, Query, Vec3, Weight};

use super::shape::{SIZE, Shape};
use super::{AccuracyRow, Method, Settings, angle_deg, random_rotation, wrench_errors};
use crate::harness::context::Context;

/// Half of the edge of the probe, a cube whose shell feels force and torque, in metres.
const HALF_PROBE: f64 = 0.04;

/// Enough points for the error of the shell to be negligible; it is the same in all fields.
const PROBE_POINTS: u32 = 10_000;

impl Settings {
    pub(super) fn fields(
        &self,
        shape: Shape,
        method: Method,
        context: &Context,
    ) -> Result<Vec<AccuracyRow>, String> {
        let mesh = shape.mesh()?;
        let probe = Mesh::cuboid([2.0 * HALF_PROBE; 3]).map_err(|e| e.to_string())?;
        let probe_options = BuildOptions {
            points: PointCount::About(PROBE_POINTS),
            ..BuildOptions::default()
        };
        let built = |mesh: &Mesh, options: &BuildOptions| {
            let cached = context.assets.get(mesh, options, &|_| ());
            cached.map(|cached| cached.asset).map_err(|e| e.to_string())
        };
        let probe = built(&probe, &probe_options)?;
        let mut rows = Vec::new();
        for &size in &self.voxel_sizes_m {
            let options = BuildOptions {
                resolution: Resolution::VoxelSize(size),
                encoding: method.encoding(),
                density: method.density(),
                // The shape is never the shell.
                points: PointCount::About(100),
                ..BuildOptions::default()
            };
            let asset = built(&mesh, &options)?;
            let field = method.field(&asset.voxelmap);
            let first = rows.len();
            self.values(shape, &*field, &mut rows);
            self.wrenches(shape, &probe.tree, &*field, &mut rows);
            for row in &mut rows[first..] {
                row.voxel_size_m = Some(size);
            }
        }
        Ok(rows)
    }

    /// The same points for all methods and sizes.
    fn values(&self, shape: Shape, field: &dyn DistanceField, rows: &mut Vec<AccuracyRow>) {
        let mut rng = ChaCha8Rng::seed_from_u64(self.seed);
        for sample in 0..self.samples {
            // Rounded to 32 bits, as the field receives it.
            let point = self.point_near(shape, &mut rng).as_vec3();
            let inward = shape.inward(point.as_dvec3());
            // The inward normal of a shell that touches here is opposite.
            let reported = field.penetration(point, -inward.as_vec3());
            let direction = field.inward_direction(point).as_dvec3();
            let exact = shape.penetration(point.as_dvec3());
            rows.push(AccuracyRow {
                sample,
                error_m: Some(f64::from(reported) - exact),
                error_bound_m: Some(field.error_bound().into()),
                direction_deg: angle_deg(direction, inward),
                ..AccuracyRow::default()
            });
        }
    }

    /// A point uniformly distributed near the surface.
    fn point_near(&self, shape: Shape, rng: &mut ChaCha8Rng) -> DVec3 {
        loop {
            let unit: [f64; 3] = rng.random();
            let point = (DVec3::from_array(unit) * 2.0 - 1.0) * (SIZE + self.band_m);
            if shape.penetration(point).abs() <= self.band_m {
                return point;
            }
        }
    }

    /// Force and torque on a cube that is pressed into the field, against those in the exact one.
    fn wrenches(
        &self,
        shape: Shape,
        probe: &PointSphereTree<'_>,
        field: &dyn DistanceField,
        rows: &mut Vec<AccuracyRow>,
    ) {
        let mut rng = ChaCha8Rng::seed_from_u64(self.seed.wrapping_add(1));
        let exact_field = shape.field();
        for sample in 0..self.poses {
            let at = self.point_near(shape, &mut rng);
            // The faces of the cube are closest to its centre, so that it always overlaps.
            let middle = at - shape.inward(at) * (HALF_PROBE - self.depth_m);
            let rotation = random_rotation(&mut rng).as_quat();
            let pose = Pose3::from_parts(middle.as_vec3(), rotation);
            let exact = Query::new(probe, &exact_field, pose).wrench(Vec3::ZERO, Weight::Area);
            let exact = (exact.force.as_dvec3(), exact.torque.as_dvec3());
            let wrench = Query::new(probe, field, pose).wrench(Vec3::ZERO, Weight::Area);
            let errors = wrench_errors(&wrench, exact, HALF_PROBE);
            rows.push(AccuracyRow {
                sample,
                force_error: errors.map(|e| e.0),
                torque_error: errors.map(|e| e.1),
                ..AccuracyRow::default()
            });
        }
    }
}
