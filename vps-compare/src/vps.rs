use std::sync::Arc;

use rapier3d::parry::query::{DefaultQueryDispatcher, QueryDispatcher};
use rapier3d::parry::shape::SharedShape;
use vps_build::{BuildOptions, Mesh};
use vps_core::Asset;
use vps_rapier::{Manifolds, Role, Sampling, VpsDispatcher, VpsShape};

use crate::{CollisionAlgorithm, PrepareError, Prepared, Scene};

/// Pointshell of the body against the ground.
pub struct Vps<'s> {
    /// How the body's asset is built.
    pub body: BuildOptions,
    /// What the ground is.
    pub ground: VpsGround,
    /// How a voxelmap is sampled.
    pub sampling: Sampling,
    /// Which contacts an engine gets.
    pub manifolds: Manifolds,
    /// Where assets come from.
    pub assets: &'s AssetSource<'s>,
}

/// Builds an asset, or fetches one that was built before; an error is one line of text.
pub type AssetSource<'s> = dyn Fn(&Mesh, &BuildOptions) -> Result<Arc<Asset<'static>>, String> + 's;

/// The ground of [`Vps`].
#[derive(Clone, Debug, PartialEq)]
pub enum VpsGround {
    /// A voxelmap of the box, as in the paper.
    Voxelmap(BuildOptions),
    /// The box itself.
    Cuboid,
}

impl CollisionAlgorithm for Vps<'_> {
    fn prepare(&self, scene: &Scene<'_>) -> Result<Prepared, PrepareError> {
        let asset =
            |mesh: &Mesh, options| (self.assets)(mesh, options).map_err(PrepareError::Asset);
        let body = asset(scene.body, &self.body)?;
        let size = vec![
            ("points", body.tree.point_count()),
            ("levels", body.tree.level_count() as usize),
        ];
        let ground = match &self.ground {
            VpsGround::Voxelmap(options) => {
                let flat = |_| PrepareError::Flat("ground");
                let mesh = Mesh::cuboid(scene.ground_extents).map_err(flat)?;
                let ground = VpsShape::new(asset(&mesh, options)?);
                ground.with_role(Role::Voxelmap).into()
            }
            VpsGround::Cuboid => {
                let [x, y, z] = scene.ground_extents.map(|e| 0.5 * e as f32);
                SharedShape::cuboid(x, y, z)
            }
        };
        let dispatcher = VpsDispatcher {
            sampling: self.sampling,
            manifolds: self.manifolds,
        };
        Ok(Prepared {
            body: VpsShape::new(body).with_role(Role::Pointshell).into(),
            ground,
            dispatcher: Arc::new(dispatcher.chain(DefaultQueryDispatcher)),
            size,
        })
    }
}
