//! What jobs need: models, assets and algorithms made ready, each once.

use std::borrow::Cow;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::rc::Rc;
use std::time::Instant;

use serde::{Deserialize, Serialize};
use vps_build::{
    AssetCache, BuildOptions, CachedAsset, Mesh, PointCount, Resolution, mass_properties, read_mesh,
};
use vps_compare::oracle::PlaneOracle;
use vps_compare::{
    AssetSource, CollisionAlgorithm, ConvexDecomposition, ConvexHull, Ground, Prepared, Scene,
    Trimesh, Voxels, Vps, VpsGround,
};
use vps_core::MassProperties;
use vps_rapier::{Manifolds, Sampling};

use crate::algorithms::{self, Algorithms, Method, SamplingName};
use crate::ball::Ball;
use crate::models::{Models, sha256};

/// Everything jobs have in common.
pub(crate) struct Lab {
    pub(crate) algorithms: Algorithms,
    pub(crate) models: Models,
    pub(crate) assets: AssetCache,
    bodies: RefCell<BTreeMap<String, Rc<Body>>>,
    ready: RefCell<BTreeMap<String, Rc<Ready>>>,
}

/// A model in metres.
pub(crate) struct Body {
    pub(crate) mesh: Mesh,
    /// Of the solid, at density one.
    pub(crate) mass: MassProperties,
    pub(crate) oracle: PlaneOracle,
    /// Of the model's file, and how it is scaled.
    pub(crate) identity: String,
}

/// An algorithm on a body and a ground.
pub(crate) struct Ready {
    prepared: Result<Prepared, String>,
    pub(crate) preparation: Preparation,
}

impl Ready {
    /// What the algorithm made of the scene, or why it cannot.
    pub(crate) fn prepared(&self) -> Result<&Prepared, String> {
        self.prepared.as_ref().map_err(Clone::clone)
    }
}

/// What an algorithm made from the mesh.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
pub(crate) struct Preparation {
    /// All of it, with reading what an earlier run built.
    pub(crate) prepare_s: f64,
    /// Building of assets, unless an earlier run did.
    pub(crate) asset_build_s: Option<f64>,
    /// Such as `799 points, 5 levels`.
    pub(crate) size: String,
    /// What its assets are known by, body and ground.
    pub(crate) assets: String,
    /// Size of their files.
    pub(crate) asset_bytes: u64,
    /// Of both shapes in memory, counted or estimated.
    pub(crate) memory_bytes: u64,
}

impl Lab {
    pub(crate) fn new(algorithms: Algorithms, models: Models, assets: AssetCache) -> Self {
        Self {
            algorithms,
            models,
            assets,
            bodies: RefCell::default(),
            ready: RefCell::default(),
        }
    }

    /// A model, by its name in `models.toml` or the path of a mesh, `scale` metres a unit.
    pub(crate) fn body(&self, model: &str, scale: f64) -> Result<Rc<Body>, String> {
        let key = format!("{model} x {scale}");
        if let Some(body) = self.bodies.borrow().get(&key) {
            return Ok(body.clone());
        }
        let path = self.models.file(model).map_err(|e| e.to_string())?;
        let named = |e: &dyn std::fmt::Display| format!("{}: {e}", path.display());
        let bytes = std::fs::read(&path).map_err(|e| named(&e))?;
        let mesh = read_mesh(&path, None).map_err(|e| e.to_string())?;
        let mesh = mesh.scaled(scale).map_err(|e| named(&e))?;
        let body = Rc::new(Body {
            mass: mass_properties(&mesh).map_err(|e| named(&e))?,
            oracle: PlaneOracle::new(&mesh).map_err(|e| named(&e))?,
            mesh,
            identity: format!("{} x {scale}", sha256(&bytes)),
        });
        self.bodies.borrow_mut().insert(key, body.clone());
        Ok(body)
    }

    /// An algorithm of the list, made ready for a model on a box of the given edge lengths.
    pub(crate) fn on_box(
        &self,
        algorithm: &str,
        body: &Body,
        extents_m: [f64; 3],
    ) -> Result<Rc<Ready>, String> {
        self.ready(algorithm, &body.identity, extents_m, || {
            Ok(Cow::Borrowed(&body.mesh))
        })
    }

    /// The same for a ball, an icosphere divided so many times.
    pub(crate) fn ball_on_box(
        &self,
        algorithm: &str,
        (radius_m, subdivisions): (f64, u32),
        extents_m: [f64; 3],
    ) -> Result<Rc<Ready>, String> {
        let identity = format!("ball {radius_m} {subdivisions}");
        self.ready(algorithm, &identity, extents_m, || {
            let ball = Mesh::icosphere(radius_m, subdivisions);
            ball.map(Cow::Owned).map_err(|e| e.to_string())
        })
    }

    /// `identity` tells meshes apart; the mesh is asked for once.
    fn ready<'m>(
        &self,
        algorithm: &str,
        identity: &str,
        extents_m: [f64; 3],
        mesh: impl FnOnce() -> Result<Cow<'m, Mesh>, String>,
    ) -> Result<Rc<Ready>, String> {
        let method = &self.algorithms.get(algorithm)?.method;
        let key = format!("{algorithm} {identity} {extents_m:?}");
        if let Some(ready) = self.ready.borrow().get(&key) {
            return Ok(ready.clone());
        }
        let mesh = mesh()?;
        let scene = Scene {
            body: &mesh,
            ground: Ground::Cuboid(extents_m),
        };
        let ready = Rc::new(prepare(method, &scene, &self.assets));
        self.ready.borrow_mut().insert(key, ready.clone());
        Ok(ready)
    }
}

fn prepare(method: &Method, scene: &Scene<'_>, assets: &AssetCache) -> Ready {
    let used: RefCell<Vec<CachedAsset>> = RefCell::default();
    let get = |mesh: &Mesh, options: &BuildOptions| {
        let kept = assets
            .get(mesh, options, &|_| ())
            .map_err(|e| e.to_string())?;
        let asset = kept.asset.clone();
        used.borrow_mut().push(kept);
        Ok(asset)
    };
    let start = Instant::now();
    let result = match method {
        Method::Vps(settings) => vps(settings, &get).prepare(scene),
        Method::Ball => Ball.prepare(scene),
        Method::ConvexHull => ConvexHull.prepare(scene),
        &Method::ConvexDecomposition {
            parts,
            vertices,
            resolution,
        } => ConvexDecomposition {
            parts,
            vertices,
            resolution,
        }
        .prepare(scene),
        Method::Trimesh => Trimesh.prepare(scene),
        &Method::Voxels { resolution } => Voxels { resolution }.prepare(scene),
    };
    let prepare_s = start.elapsed().as_secs_f64();
    let prepared = result.map_err(|e| e.to_string());
    let size = prepared
        .iter()
        .flat_map(|p| p.size.iter().chain(&p.ground_size));
    let used = used.into_inner();
    let preparation = Preparation {
        prepare_s,
        asset_build_s: used
            .iter()
            .filter_map(|kept| kept.build_s)
            .reduce(|a, b| a + b),
        size: joined(size.map(|(what, n)| format!("{n} {what}"))),
        assets: joined(used.iter().map(|kept| kept.key.clone())),
        asset_bytes: used.iter().map(|kept| kept.file_bytes).sum(),
        memory_bytes: prepared.as_ref().map_or(0, |p| p.memory().bytes as u64),
    };
    Ready {
        prepared,
        preparation,
    }
}

fn joined(parts: impl Iterator<Item = String>) -> String {
    parts.collect::<Vec<_>>().join(", ")
}

/// How the body's asset of a VPS algorithm is built.
pub(crate) fn body_options(settings: &algorithms::Vps) -> BuildOptions {
    BuildOptions {
        resolution: Resolution::VoxelSize(settings.voxel_size_m),
        margin: settings.margin,
        points: PointCount::About(settings.points),
        branching: settings.branching,
        ..BuildOptions::default()
    }
}

fn vps<'a>(settings: &algorithms::Vps, assets: &'a AssetSource<'a>) -> Vps<'a> {
    let ground = match settings.ground_voxel_size_m {
        Some(size) => VpsGround::Voxelmap(BuildOptions {
            resolution: Resolution::VoxelSize(size),
            margin: settings.ground_margin.unwrap_or(4),
            // It is never the shell.
            points: PointCount::About(100),
            ..BuildOptions::default()
        }),
        None => VpsGround::Cuboid,
    };
    Vps {
        body: body_options(settings),
        ground,
        sampling: match settings.sampling {
            SamplingName::Trilinear => Sampling::Trilinear,
            SamplingName::Local => Sampling::Local,
        },
        manifolds: settings
            .segments
            .map_or(Manifolds::Spread, Manifolds::Segments),
        assets,
    }
}
