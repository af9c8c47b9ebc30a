use std::sync::Arc;

use rapier3d::parry::query::{DefaultQueryDispatcher, QueryDispatcher};
use rapier3d::parry::shape::SharedShape;
use serde::{Deserialize, Serialize};
use vps_build::{BuildOptions, Density, Mesh, PointCount, Resolution};
use vps_core::Asset;
use vps_rapier::{ContactPoints, Manifolds, Role, Sampling, VpsDispatcher, VpsShape};

use crate::algorithm::{AssetSource, CollisionAlgorithm, PrepareError, Sizes};
use crate::algorithms::parry_pair::cuboid;
use crate::memory::Memory;
use crate::prepared::{Prepared, Size};
use crate::scene::{Ground, Scene};

/// Voxelmap-Pointshell: the pointshell of one body in the field of the other.
///
/// A mesh as the ground is treated as the body is: of the two pointshells, the one whose points are
/// closer together is in the voxelmap of the other, and the other way round if the other is thin.
/// On a box the body is the shell.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct Vps {
    /// Number of points, to within 2 %.
    pub points: u32,
    /// Children of a cluster K.
    pub branching: u32,
    /// Length of a voxel's edge in metres.
    pub voxel_size_m: Option<f64>,
    /// Outer layers of voxels around the box of a mesh.
    pub margin: u32,
    /// How a voxelmap is sampled.
    #[serde(with = "SamplingName")]
    pub sampling: Sampling,
    /// Which point of the surface a contact has.
    #[serde(with = "ContactPointsName")]
    pub contact_points: ContactPoints,
    /// The level whose clusters give a contact each (section 2.4), 1 at the top. Without it there
    /// are four contacts that span the largest area.
    pub segments: Option<u32>,
    /// Length of the edge of a box's voxels in metres. Without it a box is an exact cuboid.
    pub ground_voxel_size_m: Option<f64>,
    /// Outer layers of voxels around a box; 4 without it.
    pub ground_margin: Option<u32>,
    /// Whether every voxel of a box is stored; otherwise its size decides.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub ground_is_dense: bool,
    /// Voxels along the longest side of a mesh, if there is no [`Self::voxel_size_m`]. Without
    /// either the builder chooses.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub voxels: Option<u32>,
}

/// Names of samplings in files.
#[derive(Deserialize, Serialize)]
#[serde(remote = "Sampling", rename_all = "snake_case")]
enum SamplingName {
    Trilinear,
    Local,
}

/// Names of contact points in files.
#[derive(Deserialize, Serialize)]
#[serde(remote = "ContactPoints", rename_all = "snake_case")]
enum ContactPointsName {
    Refined,
    Shell,
}

impl Default for Vps {
    /// The defaults of the builder, with 10 000 points; a box is exact.
    fn default() -> Self {
        let options = BuildOptions::default();
        Self {
            points: 10_000,
            branching: options.branching,
            voxel_size_m: None,
            margin: options.margin,
            sampling: Sampling::default(),
            contact_points: ContactPoints::default(),
            segments: None,
            ground_voxel_size_m: None,
            ground_margin: None,
            ground_is_dense: false,
            voxels: None,
        }
    }
}

impl CollisionAlgorithm for Vps {
    fn about(&self) -> &'static str {
        "The pointshell whose points are closer together in the voxelmap of the other, and the other \
         way round if the other is thin"
    }

    fn label(&self) -> &'static str {
        "VPS"
    }

    fn color(&self) -> [u8; 3] {
        [0x00, 0x72, 0xb2]
    }

    fn check(&self) -> Result<(), String> {
        if self.segments == Some(0) {
            return Err("segments is a level from 1 on".into());
        }
        Ok(())
    }

    fn set_sizes(&mut self, sizes: &Sizes) {
        self.points = sizes.points;
        self.voxels = Some(sizes.voxels);
    }

    fn prepare_with(
        &self,
        scene: &Scene<'_>,
        assets: &AssetSource<'_>,
    ) -> Result<Prepared, PrepareError> {
        self.prepare_as(Role::Mixed, scene, assets)
    }
}

impl Vps {
    /// The build options of the asset of a mesh.
    pub fn build_options(&self) -> BuildOptions {
        let along_longest = self.voxels.map(Resolution::VoxelsAlongLongest);
        let resolution = self.voxel_size_m.map(Resolution::VoxelSize);
        BuildOptions {
            resolution: resolution.or(along_longest).unwrap_or(Resolution::Auto),
            margin: self.margin,
            points: PointCount::About(self.points),
            branching: self.branching,
            ..BuildOptions::default()
        }
    }

    /// The build options of a box that is a voxelmap; `None` if it is an exact cuboid.
    pub fn box_options(&self) -> Option<BuildOptions> {
        let default = BuildOptions::default();
        self.ground_voxel_size_m.map(|size| BuildOptions {
            resolution: Resolution::VoxelSize(size),
            margin: self.ground_margin.unwrap_or(default.margin),
            // A box is never the shell.
            points: PointCount::About(100),
            density: if self.ground_is_dense {
                Density::Dense
            } else {
                default.density
            },
            ..default
        })
    }

    /// Prepares a scene with a role for both of two meshes.
    pub(super) fn prepare_as(
        &self,
        role: Role,
        scene: &Scene<'_>,
        assets: &AssetSource<'_>,
    ) -> Result<Prepared, PrepareError> {
        let asset = |mesh: &Mesh, options: &BuildOptions| {
            let asset = assets(mesh, options).map_err(PrepareError::Asset)?;
            // Poses are those of meshes, and in 32 bits.
            if asset.origin == [0.0; 3] {
                Ok(asset)
            } else {
                Err(PrepareError::FarFromOrigin)
            }
        };
        let body = asset(scene.body, &self.build_options())?;
        let size = size_of_asset(&body);
        let (body, ground, ground_size) = match scene.ground {
            Ground::Mesh(mesh) => {
                let ground = asset(mesh, &self.build_options())?;
                let size = size_of_asset(&ground);
                (shape(body, role), shape(ground, role), size)
            }
            Ground::Cuboid(extents) => {
                let ground = match self.box_options() {
                    Some(options) => {
                        let no_volume = |_| PrepareError::NoVolume("ground");
                        let mesh = Mesh::cuboid(extents).map_err(no_volume)?;
                        shape(asset(&mesh, &options)?, Role::Voxelmap)
                    }
                    None => {
                        let cuboid = cuboid(extents);
                        let memory = Memory::of_parry(&*cuboid);
                        (cuboid, memory)
                    }
                };
                (shape(body, Role::Pointshell), ground, Size::new())
            }
        };
        let dispatcher = VpsDispatcher {
            sampling: self.sampling,
            contact_points: self.contact_points,
            manifolds: self
                .segments
                .map_or(Manifolds::Reduced, Manifolds::Segments),
        };
        Ok(Prepared {
            body: body.0,
            ground: ground.0,
            dispatcher: Arc::new(dispatcher.chain(DefaultQueryDispatcher)),
            size,
            ground_size,
            memory: body.1.and(ground.1),
        })
    }
}

/// The shape of an asset, and the memory of map and tree.
fn shape(asset: Arc<Asset<'static>>, role: Role) -> (SharedShape, Memory) {
    let memory = Memory {
        bytes: asset.voxelmap.store().byte_len() + asset.tree.byte_len(),
        is_estimate: false,
    };
    (VpsShape::new(asset).with_role(role).into(), memory)
}

fn size_of_asset(asset: &Asset<'_>) -> Size {
    vec![
        ("points", asset.tree.point_count()),
        ("levels", asset.tree.level_count() as usize),
    ]
}
