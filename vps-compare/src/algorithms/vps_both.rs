use serde::{Deserialize, Serialize};
use vps_rapier::Role;

use crate::algorithm::{AssetSource, CollisionAlgorithm, PrepareError, Sizes};
use crate::algorithms::Vps;
use crate::prepared::Prepared;
use crate::scene::Scene;

/// [`Vps`] with each pointshell in the voxelmap of the other. On a box it is the same as [`Vps`].
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
#[serde(transparent)]
pub struct VpsBoth(pub Vps);

impl CollisionAlgorithm for VpsBoth {
    fn about(&self) -> &'static str {
        "Each pointshell in the voxelmap of the other"
    }

    fn label(&self) -> &'static str {
        "VPS, both ways"
    }

    fn color(&self) -> [u8; 3] {
        [0xd5, 0x5e, 0x00]
    }

    fn check(&self) -> Result<(), String> {
        self.0.check()
    }

    fn set_sizes(&mut self, sizes: &Sizes) {
        self.0.set_sizes(sizes);
    }

    fn prepare_with(
        &self,
        scene: &Scene<'_>,
        assets: &AssetSource<'_>,
    ) -> Result<Prepared, PrepareError> {
        self.0.prepare_as(Role::Both, scene, assets)
    }
}
