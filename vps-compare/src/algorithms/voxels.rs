use rapier3d::math::Vector;
use rapier3d::parry::shape::{SharedShape, Voxels as ParryVoxels};
use rapier3d::parry::transformation::voxelization::{FillMode, VoxelSet};
use serde::{Deserialize, Serialize};
use vps_build::Mesh;

use crate::algorithm::{AssetSource, CollisionAlgorithm, PrepareError, Sizes};
use crate::algorithms::parry_pair::parry_pair;
use crate::precision::single;
use crate::prepared::{Prepared, Size};
use crate::scene::Scene;

/// Filled voxels, each a cube: the `Voxels` of parry.
///
/// Every voxel that a triangle passes through is a whole cube, so that a corner of a body can be up
/// to the diagonal of a voxel outside of its mesh. Between two such bodies parry can report
/// contacts away from the cubes of either, and so false touches.
#[derive(Clone, Copy, Debug, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct Voxels {
    /// Voxels along the longest side of a mesh, at least 1.
    pub resolution: u32,
}

impl Default for Voxels {
    /// 100 voxels along the longest side.
    fn default() -> Self {
        Self { resolution: 100 }
    }
}

impl CollisionAlgorithm for Voxels {
    fn about(&self) -> &'static str {
        "Filled voxels, as parry has them"
    }

    fn label(&self) -> &'static str {
        "voxels of parry"
    }

    fn color(&self) -> [u8; 3] {
        [0xe6, 0x9f, 0x00]
    }

    fn set_sizes(&mut self, sizes: &Sizes) {
        self.resolution = sizes.voxels;
    }

    fn prepare_with(
        &self,
        scene: &Scene<'_>,
        _assets: &AssetSource<'_>,
    ) -> Result<Prepared, PrepareError> {
        parry_pair(scene, |mesh| self.voxels_of(mesh))
    }
}

impl Voxels {
    fn voxels_of(&self, mesh: &Mesh) -> Result<(SharedShape, Size), PrepareError> {
        let (low, high) = mesh.bounds();
        let voxel_size = (high - low).max_element() / f64::from(self.resolution.max(1));
        let mut vertices = single(mesh.vertices());
        // parry fills a lattice with a centre at the lowest corner of all vertices, but stores one
        // with centres at halves. An additional vertex without triangles aligns the two, so that
        // nothing is shifted.
        let corner = ((low / voxel_size).floor() - 0.5) * voxel_size;
        vertices.push(corner.as_vec3());
        let filled = VoxelSet::with_voxel_size(
            &vertices,
            mesh.triangles(),
            voxel_size as f32,
            FillMode::FloodFill {
                detect_cavities: false,
            },
            false,
        );
        let centers = filled.voxels().iter().map(|v| filled.get_voxel_point(v));
        let centers: Vec<_> = centers.collect();
        if centers.is_empty() {
            return Err(PrepareError::NoVolume("voxels"));
        }
        let shape = ParryVoxels::from_points(Vector::splat(voxel_size as f32), &centers);
        Ok((SharedShape::new(shape), vec![("voxels", centers.len())]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Ground;

    #[test]
    fn a_ball_is_where_it_was_and_no_more_than_a_voxel_thicker() {
        let ball = Mesh::icosphere(1.0, 4).unwrap();
        // Off the lattice by different fractions of a voxel along each axis.
        let off = glamx::DVec3::new(0.31, -5.17, 0.123);
        let vertices: Vec<_> = ball.vertices().iter().map(|v| *v + off).collect();
        let moved = Mesh::new(&vertices, ball.triangles()).unwrap();
        let scene = Scene {
            body: &moved,
            ground: Ground::Cuboid([1.0; 3]),
        };
        let prepared = Voxels { resolution: 20 }.prepare(&scene).unwrap();
        let voxels = prepared.body.as_voxels().unwrap();
        let filled = voxels.voxels().filter(|v| !v.state.is_empty());
        let distances: Vec<_> = filled.map(|v| v.center.as_dvec3().distance(off)).collect();
        assert_eq!(distances.len(), prepared.size[0].1);
        let furthest = distances.iter().copied().fold(0.0, f64::max);
        // Half of the diagonal of a voxel.
        assert!(furthest <= 1.0 + 0.1 * 0.867, "{furthest}");
        let volume = distances.len() as f64 * 0.1_f64.powi(3);
        assert!((4.2..5.6).contains(&volume), "{volume}");
    }
}
