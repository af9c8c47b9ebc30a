//! Measures queries: times, and clusters and points tested.

use std::sync::Arc;
use std::time::{Duration, Instant};

use rapier3d::math::{Pose, Rotation, Vector};
use serde::Serialize;
use vps_build::{BuildOptions, Clustering, Density, Mesh, PointCount, Resolution, models};
use vps_compare::{Contacts, Ground, Prepared, Scene};
use vps_core::{Asset, DistanceField, PointSphereTree, Query, Work};

use super::poses::PoseSet;
use super::query_kind::{QueryKind, SegmentEnds};
use super::{Settings, spacing};
use crate::experiments::shared::query_field::{QueryField, asset, cuboid, shell, voxelmap_of_box};
use crate::harness::context::Context;

/// One query in one round; columns that do not apply are empty.
#[derive(Clone, Debug, Default, Serialize)]
pub(super) struct QueryRow {
    query: String,
    /// Points of the shell, or triangles of the source mesh, where they grow.
    size: Option<f64>,
    /// Mean time of a pose.
    time_us: Option<f64>,
    /// Spheres and points tested at a pose, on average.
    spheres: Option<f64>,
    points: Option<f64>,
    /// Contacts at a pose, on average.
    contacts: Option<f64>,
}

/// Queries of a tree in a field at poses.
struct Asked<'a, F> {
    tree: &'a PointSphereTree<'a>,
    field: &'a F,
    poses: &'a [Pose],
    prediction_m: f32,
}

/// The name of the query for contact manifolds.
pub(super) const MANIFOLDS: &str = "manifolds";

impl Settings {
    /// Mean time of a pose: passes over all poses until the measured time is over, after one to warm
    /// up.
    fn time_us(&self, poses: usize, mut pass: impl FnMut()) -> f64 {
        pass();
        let enough = Duration::from_millis(self.measured_ms);
        let start = Instant::now();
        for passes in 1.. {
            pass();
            let elapsed = start.elapsed();
            if elapsed >= enough {
                return elapsed.as_secs_f64() * 1e6 / f64::from(passes) / poses as f64;
            }
        }
        f64::NAN
    }

    /// Contact manifolds as an engine asks for them: contacts persist through steps in a row.
    pub(super) fn manifolds(
        &self,
        prepared: &Prepared,
        context: &Context,
    ) -> Result<QueryRow, String> {
        let poses = self.fallen(context)?;
        let mut is_supported = true;
        let time_us = self.time_us(poses.len(), || {
            for steps in poses.chunks(self.steps_in_a_row) {
                let mut contacts = Contacts::default();
                for pose in steps {
                    let result = prepared.query(pose, self.fall.prediction_m, &mut contacts);
                    is_supported &= result.is_ok();
                }
            }
        });
        timed_manifolds(time_us, is_supported)
    }

    /// The body in itself. Triangle meshes take seconds: they are asked once, at the first two poses.
    pub(super) fn interlocked(&self, what: &str, context: &Context) -> Result<QueryRow, String> {
        let body = self.fall.body(context)?;
        // Turned half round and pushed together until some centimetres are shared.
        let poses: [Pose; 6] = std::array::from_fn(|i| {
            let turn = Rotation::from_scaled_axis(Vector::new(0.3, 1.0, 0.2) * (1.05 * i as f32));
            Pose::from_parts(Vector::new(0.15, 0.02, 0.05), turn)
        });
        let scene = Scene {
            body: &body.mesh,
            ground: Ground::Mesh(&body.mesh),
        };
        let assets = |mesh: &Mesh, options: &BuildOptions| Ok(asset(context, mesh, options)?.asset);
        let method = &context.algorithms.get(what)?.method;
        let prepared = method.prepare_with(&scene, &assets);
        let prepared = prepared.map_err(|e| e.to_string())?;
        let mut is_supported = true;
        let mut ask = |pose: &Pose, contacts: &mut Contacts| {
            let result = prepared.query(pose, self.fall.prediction_m, contacts);
            is_supported &= result.is_ok();
        };
        let time_us = if what == self.trimesh {
            let start = Instant::now();
            for pose in &poses[..2] {
                ask(pose, &mut Contacts::default());
            }
            start.elapsed().as_secs_f64() * 1e6 / 2.0
        } else {
            let mut contacts = Contacts::default();
            self.time_us(poses.len(), || {
                for pose in &poses {
                    ask(pose, &mut contacts);
                }
            })
        };
        timed_manifolds(time_us, is_supported)
    }

    /// All queries of the shell in a field, by its name.
    pub(super) fn in_field(
        &self,
        set: PoseSet,
        field: &str,
        context: &Context,
    ) -> Result<Vec<QueryRow>, String> {
        let field = QueryField::ALL.into_iter().find(|f| f.name() == field);
        let field = field.ok_or("no such field")?;
        let extents_m = match set {
            PoseSet::Inside => self.around_extents_m,
            _ => self.fall.ground_extents_m,
        };
        let shell = self.shell(context)?;
        let (poses, prediction_m) = self.poses(set, &shell, context)?;
        Ok(match field.density() {
            None => {
                let field = cuboid(extents_m);
                let asked = Asked::new(&shell.tree, &field, &poses, prediction_m);
                self.time(&QueryKind::ALL, &asked)
            }
            Some(density) => {
                let map = voxelmap_of_box(context, &self.shell, extents_m, density)?.asset;
                let field = map.voxelmap.trilinear();
                let asked = Asked::new(&shell.tree, &field, &poses, prediction_m);
                self.time(&QueryKind::ALL, &asked)
            }
        })
    }

    /// Clusters and points tested on the dense map of the ground, by how points are put into
    /// clusters.
    pub(super) fn by_clustering(
        &self,
        clustering: &str,
        context: &Context,
    ) -> Result<Vec<QueryRow>, String> {
        let clustering = match clustering {
            "bisect" => Clustering::Bisect,
            _ => Clustering::BottomUp { seed: 1 },
        };
        let options = BuildOptions {
            clustering,
            ..context.algorithms.vps(&self.shell)?.build_options()
        };
        let body = self.fall.body(context)?;
        let shell = asset(context, &body.mesh, &options)?.asset;
        let ground = self.dense_ground(context)?;
        let (poses, prediction_m) = self.poses(PoseSet::GroundAhead, &shell, context)?;
        let field = ground.voxelmap.trilinear();
        let asked = Asked::new(&shell.tree, &field, &poses, prediction_m);
        let ends = SegmentEnds::of(&shell.tree);
        Ok(QueryKind::ALL.map(|kind| asked.count(kind, &ends)).into())
    }

    /// The same surface by the spacing of its points, on the dense map of the ground.
    pub(super) fn by_spacing(
        &self,
        name: &str,
        context: &Context,
    ) -> Result<Vec<QueryRow>, String> {
        let spacing_m = self.point_spacings_m.iter().find(|m| spacing(**m) == name);
        let options = BuildOptions {
            points: PointCount::Spacing(*spacing_m.ok_or("no such spacing")?),
            ..context.algorithms.vps(&self.shell)?.build_options()
        };
        let body = self.fall.body(context)?;
        let shell = asset(context, &body.mesh, &options)?.asset;
        let ground = self.dense_ground(context)?;
        let field = ground.voxelmap.trilinear();
        let poses = self.fallen_once(context)?;
        let asked = Asked::new(&shell.tree, &field, &poses, self.points_prediction_m);
        let mut rows = self.time(&QueryKind::BY_POINTS, &asked);
        let contacts = asked.contacts();
        for row in &mut rows {
            row.size = Some(shell.tree.point_count() as f64);
            row.contacts = Some(contacts);
        }
        Ok(rows)
    }

    /// A torus in itself by its triangles, with the same points and voxels.
    pub(super) fn torus_in_torus(
        &self,
        detail: &str,
        context: &Context,
    ) -> Result<Vec<QueryRow>, String> {
        let mesh = models::torus(detail.parse().map_err(|_| "no such detail")?);
        let options = BuildOptions {
            resolution: Resolution::VoxelSize(self.tori.voxel_size_m),
            margin: self.tori.margin,
            points: PointCount::About(self.tori.points),
            ..BuildOptions::default()
        };
        let torus = asset(context, &mesh, &options)?.asset;
        let pose = |i| {
            let turn = Rotation::from_scaled_axis(Vector::new(0.7, 0.2, 0.5) * (0.3 * i as f32));
            Pose::from_parts(Vector::new(0.3, 0.3, 0.1), turn)
        };
        let poses: Vec<_> = (0..self.tori.poses).map(pose).collect();
        let field = torus.voxelmap.trilinear();
        let asked = Asked::new(&torus.tree, &field, &poses, self.fall.prediction_m);
        let mut rows = self.time(&QueryKind::BY_TRIANGLES, &asked);
        for row in &mut rows {
            row.size = Some(mesh.triangles().len() as f64);
        }
        Ok(rows)
    }

    fn shell(&self, context: &Context) -> Result<Arc<Asset<'static>>, String> {
        let body = self.fall.body(context)?;
        Ok(shell(context, &self.shell, &body.mesh)?.asset)
    }

    fn dense_ground(&self, context: &Context) -> Result<Arc<Asset<'static>>, String> {
        let extents_m = self.fall.ground_extents_m;
        Ok(voxelmap_of_box(context, &self.shell, extents_m, Density::Dense)?.asset)
    }

    fn time<F: DistanceField>(&self, kinds: &[QueryKind], asked: &Asked<'_, F>) -> Vec<QueryRow> {
        let ends = SegmentEnds::of(asked.tree);
        let timed = |&kind: &QueryKind| QueryRow {
            time_us: Some(self.time_us(asked.poses.len(), || {
                asked
                    .queries()
                    .for_each(|query| kind.execute(&query, &ends));
            })),
            ..asked.count(kind, &ends)
        };
        kinds.iter().map(timed).collect()
    }
}

impl<'a, F: DistanceField> Asked<'a, F> {
    fn new(
        tree: &'a PointSphereTree<'a>,
        field: &'a F,
        poses: &'a [Pose],
        prediction_m: f32,
    ) -> Self {
        Self {
            tree,
            field,
            poses,
            prediction_m,
        }
    }

    fn queries(&self) -> impl Iterator<Item = Query<'_, F>> {
        let query = |pose: &Pose| {
            Query::new(self.tree, self.field, *pose).with_prediction(self.prediction_m)
        };
        self.poses.iter().map(query)
    }

    /// Spheres and points tested.
    fn count(&self, kind: QueryKind, ends: &SegmentEnds) -> QueryRow {
        let work = Work::default();
        self.queries()
            .for_each(|query| kind.execute(&query.observed_by(&work), ends));
        QueryRow {
            query: kind.name(),
            spheres: Some(work.spheres() as f64 / self.poses.len() as f64),
            points: Some(work.points() as f64 / self.poses.len() as f64),
            ..QueryRow::default()
        }
    }

    fn contacts(&self) -> f64 {
        let mut contacts = 0.0;
        self.queries()
            .for_each(|query| query.for_each_contact(|_| contacts += 1.0));
        contacts / self.poses.len() as f64
    }
}

fn timed_manifolds(time_us: f64, is_supported: bool) -> Result<QueryRow, String> {
    if !is_supported {
        return Err("the dispatcher does not support this pair of shapes".into());
    }
    Ok(QueryRow {
        query: MANIFOLDS.into(),
        time_us: Some(time_us),
        ..QueryRow::default()
    })
}
