//! The models of the scenes, and the shape each collider makes of them.

use std::sync::{Arc, OnceLock};

use rapier3d::prelude::*;
use serde::{Deserialize, Serialize};
use vps_build::models::{Thread, bolt, gear, link, nut, peg, torus};
use vps_build::{AssetCache, BuildOptions, Mesh, PointCount, Resolution};
use vps_compare::{CollisionAlgorithm, ConvexDecomposition, Ground, Trimesh};
use vps_core::Asset;
use vps_rapier::VpsShape;

use super::collider::Collider;
use crate::harness::context::Context;

/// The bunny, and how finely models are represented.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ModelSettings {
    /// The bunny: a name in `models.toml` or the path of a mesh.
    pub(super) bunny: String,
    /// Length of a unit of the bunny in metres.
    pub(super) bunny_scale: f64,
    pub(super) bunny_voxel_size_m: f64,
    pub(super) bunny_points: u32,
    /// Points of the coarse shell.
    pub(super) bunny_coarse_points: u32,
    /// Largest number of convex parts of the bunny.
    pub(super) bunny_parts: usize,
    /// Largest number of convex parts of the models made by code. Their voxelmaps and shells are
    /// those `vps-build` makes without options.
    pub(super) parts: usize,
    /// Largest number of vertices of a convex part.
    pub(super) part_vertices: usize,
    /// Voxels along the longest side in VHACD.
    pub(super) decomposition_resolution: u32,
}

/// The models by name.
#[derive(Clone, Copy, Debug)]
pub(super) enum ModelName {
    /// 0.27 m wide.
    Bunny,
    /// 2 mm wide.
    SmallBunny,
    /// 5120 triangles.
    Ball,
    /// 16 teeth.
    Gear,
    /// 12 teeth as large as those of [`Gear`](Self::Gear).
    SmallGear,
    /// 0.3 m long, around the z axis.
    Bolt,
    /// 60 mm high with a clearance of 2.4 mm.
    Nut,
    /// Its hole is 0.2 m wide, around the z axis.
    Ring,
    /// 0.6 m high and 0.12 m thick, along the z axis.
    Peg,
    /// 0.2 m long, of a rod of 28 mm, along the x axis.
    Link,
    /// 0.5 m wide, with voxels half as large as it is thick.
    Plate,
}

const MODEL_COUNT: usize = 11;

/// Ratio of the sizes of the two bunnies.
pub(super) const TIMES_SMALLER: f32 = 135.0;
/// Radius of the ball in metres.
pub(super) const BALL_RADIUS: f32 = 0.1;
/// Scale of the gear of 16 teeth, which is a metre wide by itself.
pub(super) const GEAR_SCALE: f32 = 0.3;
/// Scale of bolt and nut; the bolt is a metre long by itself.
pub(super) const SCREW_SCALE: f32 = 0.3;
/// Scale of a link, which is a metre long by itself.
pub(super) const LINK_SCALE: f32 = 0.2;
/// Thickness of the plate in metres.
pub(super) const PLATE_THICKNESS: f32 = 0.002;

/// All models, each made when it is first needed.
pub(super) struct Models {
    settings: ModelSettings,
    bunny: Mesh,
    small_bunny: Mesh,
    assets: AssetCache,
    made: [OnceLock<Result<Model, String>>; MODEL_COUNT],
}

/// A body of one kilogram, in the frame of its mesh.
pub(super) struct Model {
    mesh: Mesh,
    /// Also determines how deep bodies are, whatever they collide as.
    pub(super) asset: Arc<Asset<'static>>,
    /// With the coarse shell.
    coarse: Option<Arc<Asset<'static>>>,
    decomposition_settings: ConvexDecomposition,
    decomposition: OnceLock<Result<SharedShape, String>>,
    trimesh: OnceLock<Result<SharedShape, String>>,
}

impl Models {
    /// Loads the bunny.
    pub(super) fn new(settings: &ModelSettings, context: &Context) -> Result<Self, String> {
        let small = settings.bunny_scale / f64::from(TIMES_SMALLER);
        let mesh = |scale| Ok::<_, String>(context.body(&settings.bunny, scale)?.mesh.clone());
        Ok(Self {
            settings: settings.clone(),
            bunny: mesh(settings.bunny_scale)?,
            small_bunny: mesh(small)?,
            assets: context.assets.clone(),
            made: Default::default(),
        })
    }

    pub(super) fn get(&self, name: ModelName) -> Result<&Model, String> {
        let made = self.made[name as usize].get_or_init(|| self.make(name));
        made.as_ref().map_err(Clone::clone)
    }

    fn make(&self, name: ModelName) -> Result<Model, String> {
        let settings = &self.settings;
        let usual = BuildOptions::default();
        let (mesh, scale) = match name {
            ModelName::Bunny | ModelName::SmallBunny => return self.make_bunny(name),
            ModelName::Plate => {
                let options = BuildOptions {
                    resolution: Resolution::VoxelSize(0.001),
                    ..usual
                };
                let mesh = Mesh::cuboid([0.5, 0.002, 0.5]).map_err(|e| e.to_string())?;
                return self.model(mesh, &options, None, settings.parts);
            }
            ModelName::Ball => (Mesh::icosphere(0.1, 4).map_err(|e| e.to_string())?, 1.0),
            ModelName::Gear => (gear(16), 0.3),
            ModelName::SmallGear => (gear(12), 0.3 * 12.0 / 16.0),
            ModelName::Bolt => (bolt(Thread::default(), 1.0, 48), 0.3),
            ModelName::Nut => (nut(Thread::default(), 0.2, 0.008, 48), 0.3),
            ModelName::Ring => (torus(48), 0.5),
            ModelName::Peg => (peg(48), 0.6),
            ModelName::Link => (link(32), 0.2),
        };
        let mesh = mesh.scaled(scale).map_err(|e| e.to_string())?;
        self.model(mesh, &usual, None, settings.parts)
    }

    fn make_bunny(&self, name: ModelName) -> Result<Model, String> {
        let settings = &self.settings;
        let (mesh, scale) = match name {
            ModelName::SmallBunny => {
                let scale = settings.bunny_scale / f64::from(TIMES_SMALLER);
                (&self.small_bunny, scale)
            }
            _ => (&self.bunny, settings.bunny_scale),
        };
        let voxel_size = settings.bunny_voxel_size_m / settings.bunny_scale * scale;
        let options = BuildOptions {
            resolution: Resolution::VoxelSize(voxel_size),
            points: PointCount::About(settings.bunny_points),
            ..BuildOptions::default()
        };
        let coarse = Some(settings.bunny_coarse_points);
        self.model(mesh.clone(), &options, coarse, settings.bunny_parts)
    }

    fn model(
        &self,
        mesh: Mesh,
        options: &BuildOptions,
        coarse_points: Option<u32>,
        parts: usize,
    ) -> Result<Model, String> {
        let asset = |options: &BuildOptions| {
            let cached = self.assets.get(&mesh, options, &|_| ());
            cached.map(|c| c.asset).map_err(|e| e.to_string())
        };
        let coarse = coarse_points.map(|points| {
            asset(&BuildOptions {
                points: PointCount::About(points),
                ..options.clone()
            })
        });
        Ok(Model {
            asset: asset(options)?,
            coarse: coarse.transpose()?,
            decomposition_settings: ConvexDecomposition {
                parts,
                vertices: self.settings.part_vertices,
                resolution: self.settings.decomposition_resolution,
            },
            decomposition: OnceLock::new(),
            trimesh: OnceLock::new(),
            mesh,
        })
    }
}

impl Model {
    /// # Errors
    /// When the shape cannot be made, or the model has no coarse shell.
    pub(super) fn shape(&self, collider: Collider) -> Result<SharedShape, String> {
        match collider {
            Collider::VpsCoarse => {
                let coarse = self.coarse.clone();
                let coarse = coarse.ok_or("this model has no coarse shell")?;
                Ok(VpsShape::new(coarse).into())
            }
            Collider::Vps | Collider::VpsSegments => Ok(VpsShape::new(self.asset.clone()).into()),
            Collider::Decomposition => {
                self.prepared(&self.decomposition, &self.decomposition_settings)
            }
            Collider::Trimesh => self.prepared(&self.trimesh, &Trimesh),
        }
    }

    /// The shape an algorithm makes of the mesh, made once.
    fn prepared(
        &self,
        shape: &OnceLock<Result<SharedShape, String>>,
        algorithm: &dyn CollisionAlgorithm,
    ) -> Result<SharedShape, String> {
        let make = || {
            let scene = vps_compare::Scene {
                body: &self.mesh,
                ground: Ground::Cuboid([1.0; 3]),
            };
            let prepared = algorithm.prepare(&scene).map_err(|e| e.to_string())?;
            Ok(prepared.body)
        };
        shape.get_or_init(make).clone()
    }

    /// Those of the solid, for one kilogram.
    pub(super) fn mass(&self) -> MassProperties {
        let mass = self.asset.mass;
        MassProperties::with_inertia_matrix(mass.center(), 1.0, mass.inertia_tensor(1.0))
    }

    /// A bound on the distance of the surface from the centre of mass, in metres.
    pub(super) fn reach(&self) -> f32 {
        let solid = self.asset.voxelmap.solid();
        let aside = (solid.center() - self.asset.mass.center()).length();
        aside + 0.5 * solid.extents().length()
    }
}
