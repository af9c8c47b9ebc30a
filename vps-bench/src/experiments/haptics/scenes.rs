//! The scenes: a tool and a solid that rests.

use std::sync::Arc;

use serde::{Deserialize, Serialize};
use vps_build::{BuildOptions, Density, Mesh, PointCount, Resolution};
use vps_core::{Asset, CouplingOptions, Pose3, Tool};

use super::{Settings, device, meshes};
use crate::harness::context::Context;

/// A tool, and how the solid it touches is sampled.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SceneSettings {
    /// Points of the tool.
    pub(super) points: u32,
    /// Mass of the tool.
    pub(super) mass_kg: f32,
    /// Voxels of the solid.
    pub(super) voxel_size_m: f64,
    /// Stiffness of contacts per area.
    pub(super) contact_stiffness_n_m3: f32,
}

/// The scenes by name.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(super) enum SceneName {
    /// A stylus probes the bunny.
    Stylus,
    /// A peg goes into a hole.
    Peg,
}

impl SceneName {
    pub(super) const ALL: [Self; 2] = [Self::Stylus, Self::Peg];

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Stylus => "stylus",
            Self::Peg => "peg",
        }
    }
}

/// The stores of the solid's voxelmap by name.
pub(super) const STORES: [(&str, Density); 2] =
    [("dense", Density::Dense), ("sparse", Density::Sparse)];

/// A scene, ready to be run.
pub(super) struct Scene {
    /// The pointshell.
    pub(super) tool: Arc<Asset<'static>>,
    /// The voxelmap; its frame is the world.
    pub(super) solid: Arc<Asset<'static>>,
    pub(super) contact_stiffness_n_m3: f32,
    /// The simulated tool, and what it hangs on.
    pub(super) body: Tool,
    pub(super) coupling: CouplingOptions,
    /// The device, cycle by cycle; it ends where it began.
    pub(super) device: Vec<Pose3>,
}

impl Scene {
    /// # Errors
    /// When an asset cannot be built.
    pub(super) fn new(
        settings: &Settings,
        name: SceneName,
        density: Density,
        context: &Context,
    ) -> Result<Self, String> {
        let of_scene = settings.scene(name);
        let asset = |mesh: &Mesh, options: BuildOptions| {
            let cached = context.assets.get(mesh, &options, &|_| ());
            cached.map(|c| c.asset).map_err(|e| e.to_string())
        };
        let tool_mesh = match name {
            SceneName::Stylus => meshes::stylus(),
            SceneName::Peg => meshes::peg(),
        };
        let tool = asset(
            &tool_mesh.map_err(|e| e.to_string())?,
            BuildOptions {
                points: PointCount::About(of_scene.points),
                ..BuildOptions::default()
            },
        )?;
        let solid_options = BuildOptions {
            resolution: Resolution::VoxelSize(of_scene.voxel_size_m),
            points: PointCount::About(10),
            density,
            ..BuildOptions::default()
        };
        let (solid, device) = match name {
            SceneName::Stylus => {
                let bunny = context.body(&settings.model, settings.scale)?;
                let solid = asset(&bunny.mesh, solid_options)?;
                let device = device::around(&solid);
                (solid, device)
            }
            SceneName::Peg => {
                let block = meshes::block().map_err(|e| e.to_string())?;
                (asset(&block, solid_options)?, device::into_hole())
            }
        };
        let body = Tool::of(&tool.mass, of_scene.mass_kg);
        let [linear, angular] = [
            settings.stiffness_n_m,
            settings.angular_stiffness_n_m_per_rad,
        ];
        Ok(Self {
            contact_stiffness_n_m3: of_scene.contact_stiffness_n_m3,
            coupling: CouplingOptions::critically_damped(&body, linear, angular),
            tool,
            solid,
            body,
            device,
        })
    }
}
