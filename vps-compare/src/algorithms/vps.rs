use std::sync::Arc;

use rapier3d::parry::query::{DefaultQueryDispatcher, QueryDispatcher};
use vps_build::{BuildOptions, Mesh};
use vps_core::Asset;
use vps_rapier::{Manifolds, Role, Sampling, VpsDispatcher, VpsShape};

use crate::algorithm::{CollisionAlgorithm, PrepareError};
use crate::algorithms::parry_pair::cuboid;
use crate::prepared::{Prepared, Size};
use crate::scene::{Ground, Scene};

/// Voxelmap-Pointshell: the pointshell of one body in the field of the other.
pub struct Vps<'s> {
    /// Build options of the body's asset.
    pub body: BuildOptions,
    /// The kind of ground.
    pub ground: VpsGround,
    /// How a voxelmap is sampled.
    pub sampling: Sampling,
    /// Which contacts an engine gets.
    pub manifolds: Manifolds,
    /// The source of assets.
    pub assets: &'s AssetSource<'s>,
}

/// Builds an asset, or returns a cached one; an error is one line of text.
pub type AssetSource<'s> = dyn Fn(&Mesh, &BuildOptions) -> Result<Arc<Asset<'static>>, String> + 's;

/// The ground of [`Vps`].
#[derive(Clone, Debug, PartialEq)]
pub enum VpsGround {
    /// A voxelmap, as in the paper; the body is the shell.
    Voxelmap(BuildOptions),
    /// An asset with a role like the body: with [`Role::Mixed`] the one with closer points is the
    /// shell, with [`Role::Both`] either is.
    Asset(BuildOptions, Role),
    /// The box itself.
    Cuboid,
}

impl CollisionAlgorithm for Vps<'_> {
    fn prepare(&self, scene: &Scene<'_>) -> Result<Prepared, PrepareError> {
        let asset =
            |mesh: &Mesh, options| (self.assets)(mesh, options).map_err(PrepareError::Asset);
        let body = asset(scene.body, &self.body)?;
        let ground = match &self.ground {
            VpsGround::Voxelmap(options) | VpsGround::Asset(options, _) => {
                Some(match scene.ground {
                    Ground::Cuboid(extents) => {
                        let no_volume = |_| PrepareError::NoVolume("ground");
                        asset(&Mesh::cuboid(extents).map_err(no_volume)?, options)?
                    }
                    Ground::Mesh(mesh) => asset(mesh, options)?,
                })
            }
            VpsGround::Cuboid => None,
        };
        let (body_role, ground_role) = match self.ground {
            VpsGround::Asset(_, role) => (role, role),
            _ => (Role::Pointshell, Role::Voxelmap),
        };
        let ground_size = match scene.ground {
            Ground::Mesh(_) => ground.as_ref().map_or(Size::new(), size),
            Ground::Cuboid(_) => Size::new(),
        };
        let ground = match (ground, scene.ground) {
            (Some(asset), _) => VpsShape::new(asset).with_role(ground_role).into(),
            (None, Ground::Cuboid(extents)) => cuboid(extents),
            (None, Ground::Mesh(_)) => return Err(PrepareError::NotACuboid),
        };
        let dispatcher = VpsDispatcher {
            sampling: self.sampling,
            manifolds: self.manifolds,
        };
        Ok(Prepared {
            size: size(&body),
            body: VpsShape::new(body).with_role(body_role).into(),
            ground,
            dispatcher: Arc::new(dispatcher.chain(DefaultQueryDispatcher)),
            ground_size,
        })
    }
}

fn size(asset: &Arc<Asset<'static>>) -> Size {
    vec![
        ("points", asset.tree.point_count()),
        ("levels", asset.tree.level_count() as usize),
    ]
}
