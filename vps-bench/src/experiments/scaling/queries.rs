//! Times of single queries.

use std::hint::black_box;
use std::sync::Arc;
use std::time::Instant;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rapier3d::math::{Pose, Vector};
use vps_build::{BuildOptions, Mesh, PointCount, Resolution, models};
use vps_compare::oracle::PlaneOracle;
use vps_compare::{CollisionAlgorithm, Contacts, Ground, Scene, Trimesh};
use vps_core::{Asset, Query, Trilinear, Vec3, Weight};

use super::{Case, QueryKind, Settings, TimeRow};
use crate::experiments::shared::orientation::orientation_of;
use crate::harness::context::Context;

/// Sizes of the torus with a growing number of triangles, and of the one that is pressed into a
/// voxelmap, in metres.
const TORUS_M: f64 = 0.27;
const PROBE_M: f64 = 0.1;

impl Settings {
    pub(super) fn times(
        &self,
        case: Case,
        kind: QueryKind,
        context: &Context,
    ) -> Result<Vec<TimeRow>, String> {
        let bunny = context.body(&self.model, self.scale)?;
        let mut rows = Vec::new();
        match case {
            Case::Points => {
                let ground = self.ground(context)?;
                let poses = self.poses_at(&bunny.oracle, self.fixed_depth_m);
                for &points in &self.points {
                    let shell =
                        self.asset(&bunny.mesh, self.fixed_voxel_size_m, points, context)?;
                    let count = shell.tree.point_count() as f64;
                    self.time_shell(count, kind, &shell, &ground, &poses, &mut rows);
                }
            }
            Case::Depth => {
                let ground = self.ground(context)?;
                let points = self.fixed_points;
                let shell = self.asset(&bunny.mesh, self.fixed_voxel_size_m, points, context)?;
                for &depth in &self.depths_m {
                    let poses = self.poses_at(&bunny.oracle, depth);
                    let size = f64::from(depth) * 1e3;
                    self.time_shell(size, kind, &shell, &ground, &poses, &mut rows);
                }
            }
            Case::VoxelSize => {
                let probe = models::torus(64).scaled(PROBE_M);
                let probe = probe.map_err(|e| e.to_string())?;
                let shell = self.asset(&probe, 0.002, self.fixed_points, context)?;
                let poses = self.poses_on(&bunny.mesh);
                for &size in &self.voxel_sizes_m {
                    let field = self.asset(&bunny.mesh, size, 100, context)?;
                    self.time_shell(size * 1e3, kind, &shell, &field, &poses, &mut rows);
                }
            }
            Case::Triangles => {
                let ground = self.ground(context)?;
                for &segments in &self.segments {
                    let mesh = models::torus(segments).scaled(TORUS_M);
                    let mesh = mesh.map_err(|e| e.to_string())?;
                    let oracle = PlaneOracle::new(&mesh).map_err(|e| e.to_string())?;
                    let poses = self.poses_at(&oracle, self.fixed_depth_m);
                    let size = mesh.triangles().len() as f64;
                    if kind == QueryKind::Trimesh {
                        self.time_trimesh(size, &mesh, &poses, &mut rows)?;
                    } else {
                        let voxel_size = self.fixed_voxel_size_m;
                        let shell = self.asset(&mesh, voxel_size, self.fixed_points, context)?;
                        self.time_shell(size, kind, &shell, &ground, &poses, &mut rows);
                    }
                }
            }
            Case::Bodies => return Err("the case of bodies is not a single query".into()),
        }
        Ok(rows)
    }

    fn asset(
        &self,
        mesh: &Mesh,
        voxel_size: f64,
        points: u32,
        context: &Context,
    ) -> Result<Arc<Asset<'static>>, String> {
        let options = BuildOptions {
            resolution: Resolution::VoxelSize(voxel_size),
            points: PointCount::About(points),
            ..BuildOptions::default()
        };
        let cached = context.assets.get(mesh, &options, &|_| ());
        cached.map(|cached| cached.asset).map_err(|e| e.to_string())
    }

    /// The ground as a voxelmap around its centre.
    fn ground(&self, context: &Context) -> Result<Arc<Asset<'static>>, String> {
        let mesh = Mesh::cuboid(self.ground_extents_m).map_err(|e| e.to_string())?;
        self.asset(&mesh, self.ground_voxel_size_m, 100, context)
    }

    /// Random orientations above the centre of the ground, the lowest point at a depth in it.
    fn poses_at(&self, oracle: &PlaneOracle, depth: f32) -> Vec<Pose> {
        let mut rng = ChaCha8Rng::seed_from_u64(self.seed);
        let top = 0.5 * self.ground_extents_m[1] as f32;
        let pose = |_| {
            let turned = Pose::from_parts(Vector::ZERO, orientation_of(rng.random()));
            // The current depth below the upper side.
            let below = oracle.penetration(&turned, top);
            Pose::from_parts(Vector::Y * (below - depth), turned.rotation)
        };
        (0..self.poses).map(pose).collect()
    }

    /// Random orientations at random vertices of a mesh.
    fn poses_on(&self, mesh: &Mesh) -> Vec<Pose> {
        let mut rng = ChaCha8Rng::seed_from_u64(self.seed);
        let pose = |_| {
            let corner = rng.random_range(0..mesh.vertices().len());
            // The centre of the tube, not that of the hole, is at the vertex.
            let rotation = orientation_of(rng.random());
            let aside = rotation * (Vector::X * (0.35 * PROBE_M as f32));
            Pose::from_parts(mesh.vertices()[corner].as_vec3() + aside, rotation)
        };
        (0..self.poses).map(pose).collect()
    }

    fn time_shell(
        &self,
        size: f64,
        kind: QueryKind,
        shell: &Asset<'_>,
        field: &Asset<'_>,
        poses: &[Pose],
        rows: &mut Vec<TimeRow>,
    ) {
        let map = field.voxelmap.trilinear();
        for (sample, pose) in (0..).zip(poses) {
            let query = Query::new(&shell.tree, &map, *pose);
            let mut contacts = 0.0;
            query.for_each_contact(|_| contacts += 1.0);
            rows.push(TimeRow {
                size,
                sample,
                time_us: self.least_time_us(|| kind.execute(&query, self.prediction_m)),
                contacts,
            });
        }
    }

    fn time_trimesh(
        &self,
        size: f64,
        mesh: &Mesh,
        poses: &[Pose],
        rows: &mut Vec<TimeRow>,
    ) -> Result<(), String> {
        let scene = Scene {
            body: mesh,
            ground: Ground::Cuboid(self.ground_extents_m),
        };
        let prepared = Trimesh.prepare(&scene).map_err(|e| e.to_string())?;
        for (sample, pose) in (0..).zip(poses) {
            let mut contacts = Contacts::default();
            let mut is_supported = true;
            let time_us = self.least_time_us(|| {
                contacts = Contacts::default();
                let result = prepared.query(pose, self.prediction_m, &mut contacts);
                is_supported &= result.is_ok();
            });
            if !is_supported {
                return Err("the dispatcher does not support this pair of shapes".into());
            }
            rows.push(TimeRow {
                size,
                sample,
                time_us,
                contacts: contacts.count_and_deepest().0 as f64,
            });
        }
        Ok(())
    }

    /// The least time of the repetitions, after one to warm up.
    fn least_time_us(&self, mut what: impl FnMut()) -> f64 {
        what();
        let time = |_| {
            let start = Instant::now();
            what();
            start.elapsed().as_secs_f64() * 1e6
        };
        (0..self.repeats).map(time).fold(f64::INFINITY, f64::min)
    }
}

impl QueryKind {
    fn execute(self, query: &Query<'_, Trilinear<'_>>, prediction: f32) {
        match self {
            Self::Touches => {
                black_box(query.touches());
            }
            Self::Deepest => {
                black_box(query.deepest());
            }
            Self::Manifold => {
                black_box(query.with_prediction(prediction).manifold::<4>());
            }
            Self::Wrench => {
                black_box(query.wrench(Vec3::ZERO, Weight::Area));
            }
            Self::Flat => {
                let mut count = 0_u32;
                query.for_each_contact_flat(|_| count += 1);
                black_box(count);
            }
            // A triangle mesh has no pointshell.
            Self::Trimesh => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn poses_have_the_requested_depth() {
        let mesh = Mesh::cuboid([0.2, 0.1, 0.1]).unwrap();
        let oracle = PlaneOracle::new(&mesh).unwrap();
        let text = std::fs::read_to_string(concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../experiments/scaling.toml"
        ));
        #[derive(serde::Deserialize)]
        struct File {
            scaling: Settings,
        }
        let settings = toml::from_str::<File>(&text.unwrap()).unwrap().scaling;
        let top = 0.5 * settings.ground_extents_m[1] as f32;
        for depth in [0.0, 0.001, 0.05] {
            let poses = settings.poses_at(&oracle, depth);
            assert_eq!(poses.len(), settings.poses as usize);
            for pose in poses {
                assert!((oracle.penetration(&pose, top) - depth).abs() < 1e-6);
            }
        }
    }
}
