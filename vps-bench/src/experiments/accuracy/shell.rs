//! Pointshells in a half-space.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rapier3d::glamx::{DPose3, DVec3};
use vps_build::{BuildOptions, PointCount};
use vps_core::{HalfSpace, Pose3, Query, Vec3, Weight};

use super::pressure::SurfacePieces;
use super::shape::{SIZE, Shape};
use super::{AccuracyRow, Settings, angle_deg, random_rotation, wrench_errors};
use crate::harness::context::Context;

impl Settings {
    pub(super) fn shells(
        &self,
        shape: Shape,
        context: &Context,
    ) -> Result<Vec<AccuracyRow>, String> {
        let mesh = shape.mesh()?;
        let pieces = SurfacePieces::of(&mesh);
        let mut rng = ChaCha8Rng::seed_from_u64(self.seed);
        // The same poses for all numbers of points.
        let poses = (0..self.poses).map(|_| {
            let rotation = random_rotation(&mut rng);
            let reach = shape.support(rotation.inverse() * DVec3::NEG_Y);
            let pose = DPose3::from_parts(DVec3::Y * (reach - self.depth_m), rotation);
            (pose, pieces.wrench(&pose))
        });
        let poses: Vec<_> = poses.collect();
        let ground = HalfSpace::new(Vec3::Y);
        let mut rows = Vec::new();
        for &count in &self.points {
            let options = BuildOptions {
                points: PointCount::About(count),
                ..BuildOptions::default()
            };
            let cached = context.assets.get(&mesh, &options, &|_| ());
            let asset = cached.map_err(|e| e.to_string())?.asset;
            for (sample, (pose, exact)) in (0..).zip(&poses) {
                let single = Pose3::from_parts(pose.translation.as_vec3(), pose.rotation.as_quat());
                let query = Query::new(&asset.tree, &ground, single);
                // The lowest point, even if it is above the ground.
                let lowest = query.closest().ok_or("a pose is not finite")?;
                let normal = pose.rotation * lowest.normal.as_dvec3();
                let wrench = query.wrench(Vec3::ZERO, Weight::Area);
                let errors = wrench_errors(&wrench, *exact, SIZE);
                rows.push(AccuracyRow {
                    points: Some(asset.tree.point_count() as u32),
                    sample,
                    error_m: Some(f64::from(lowest.penetration) - self.depth_m),
                    direction_deg: angle_deg(normal, DVec3::Y),
                    force_error: errors.map(|e| e.0),
                    torque_error: errors.map(|e| e.1),
                    ..AccuracyRow::default()
                });
            }
        }
        Ok(rows)
    }
}
