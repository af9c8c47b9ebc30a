//! The context of jobs: models, assets and prepared algorithms, each loaded or made once.

use std::any::{Any, TypeId};
use std::borrow::Cow;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::rc::Rc;
use std::sync::Arc;

use vps_build::{AssetCache, Mesh, mass_properties, read_mesh};
use vps_compare::oracle::PlaneOracle;
use vps_compare::{Ground, Scene};
use vps_core::MassProperties;

use crate::config::algorithms::Algorithms;
use crate::data::checksum::sha256;
use crate::harness::model_store::ModelStore;
use crate::harness::prepare::{PreparedAlgorithm, prepare};

/// Algorithms, models and assets that all jobs share.
pub(crate) struct Context {
    pub(crate) algorithms: Algorithms,
    pub(crate) models: ModelStore,
    pub(crate) assets: AssetCache,
    bodies: RefCell<BTreeMap<String, Rc<Body>>>,
    prepared: RefCell<BTreeMap<String, Rc<PreparedAlgorithm>>>,
    shared: RefCell<BTreeMap<(TypeId, String), Arc<dyn Any + Send + Sync>>>,
}

/// A model in metres.
pub(crate) struct Body {
    pub(crate) mesh: Mesh,
    /// Mass properties of the solid at density one.
    pub(crate) mass: MassProperties,
    pub(crate) oracle: PlaneOracle,
    /// Checksum of the model's file, and its scale.
    pub(crate) identity: String,
}

impl Context {
    pub(crate) fn new(algorithms: Algorithms, models: ModelStore, assets: AssetCache) -> Self {
        Self {
            algorithms,
            models,
            assets,
            bodies: RefCell::default(),
            prepared: RefCell::default(),
            shared: RefCell::default(),
        }
    }

    /// A value that several jobs share, made by the first of them; `key` distinguishes values of one
    /// type.
    pub(crate) fn once<T: Send + Sync + 'static>(
        &self,
        key: &str,
        make: impl FnOnce() -> Result<T, String>,
    ) -> Result<Arc<T>, String> {
        let key = (TypeId::of::<T>(), key.to_owned());
        let shared = self.shared.borrow().get(&key).cloned();
        if let Some(value) = shared.and_then(|value| value.downcast().ok()) {
            return Ok(value);
        }
        let value = Arc::new(make()?);
        self.shared.borrow_mut().insert(key, value.clone());
        Ok(value)
    }

    /// Loads a model by its name in `models.toml` or the path of a mesh; a unit is `scale` metres
    /// long.
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

    /// Prepares an algorithm for a model on a box of the given edge lengths.
    pub(crate) fn prepare_on_box(
        &self,
        algorithm: &str,
        body: &Body,
        extents_m: [f64; 3],
    ) -> Result<Rc<PreparedAlgorithm>, String> {
        self.prepare(algorithm, &body.identity, extents_m, || {
            Ok(Cow::Borrowed(&body.mesh))
        })
    }

    /// Prepares an algorithm for a ball, a subdivided icosphere, on a box of the given edge
    /// lengths.
    pub(crate) fn prepare_ball_on_box(
        &self,
        algorithm: &str,
        (radius_m, subdivisions): (f64, u32),
        extents_m: [f64; 3],
    ) -> Result<Rc<PreparedAlgorithm>, String> {
        let identity = format!("ball {radius_m} {subdivisions}");
        self.prepare(algorithm, &identity, extents_m, || {
            let ball = Mesh::icosphere(radius_m, subdivisions);
            ball.map(Cow::Owned).map_err(|e| e.to_string())
        })
    }

    /// `identity` distinguishes meshes; each mesh is made once.
    fn prepare<'m>(
        &self,
        algorithm: &str,
        identity: &str,
        extents_m: [f64; 3],
        mesh: impl FnOnce() -> Result<Cow<'m, Mesh>, String>,
    ) -> Result<Rc<PreparedAlgorithm>, String> {
        let method = &self.algorithms.get(algorithm)?.method;
        let key = format!("{algorithm} {identity} {extents_m:?}");
        if let Some(prepared) = self.prepared.borrow().get(&key) {
            return Ok(prepared.clone());
        }
        let mesh = mesh()?;
        let scene = Scene {
            body: &mesh,
            ground: Ground::Cuboid(extents_m),
        };
        let prepared = Rc::new(prepare(method, &scene, &self.assets));
        self.prepared.borrow_mut().insert(key, prepared.clone());
        Ok(prepared)
    }
}
