use rapier3d::math::Pose;
use rapier3d::parry::shape::SharedShape;
use rapier3d::parry::transformation::vhacd::{VHACD, VHACDParameters};

use crate::few_vertices::few_hull_vertices;
use crate::{CollisionAlgorithm, PrepareError, Prepared, Scene, parry_pair, single};

/// Convex parts by VHACD, each a hull of limited size: parry's counterpart of the HACD in the
/// paper's comparison.
#[derive(Clone, Copy, Debug)]
pub struct ConvexDecomposition {
    /// Most parts VHACD is asked for; it may give a few more or less.
    pub parts: u32,
    /// Most vertices of a part, 42 or more.
    pub vertices: usize,
    /// Voxels along the longest side VHACD works with.
    pub resolution: u32,
}

impl CollisionAlgorithm for ConvexDecomposition {
    fn prepare(&self, scene: &Scene<'_>) -> Result<Prepared, PrepareError> {
        let vertices = single(scene.body.vertices());
        let parameters = VHACDParameters {
            max_convex_hulls: self.parts,
            resolution: self.resolution,
            ..VHACDParameters::default()
        };
        let triangles = scene.body.triangles();
        let decomposition = VHACD::decompose(&parameters, &vertices, triangles, true);
        let parts: Vec<_> = decomposition
            .compute_exact_convex_hulls(&vertices, triangles)
            .into_iter()
            .filter_map(|(points, _)| {
                let few = few_hull_vertices(&points, self.vertices)?;
                Some((Pose::IDENTITY, SharedShape::convex_hull(&few)?))
            })
            .collect();
        if parts.is_empty() {
            return Err(PrepareError::NoParts);
        }
        let hulls = parts
            .iter()
            .filter_map(|(_, part)| part.as_convex_polyhedron());
        let vertices = hulls.map(|hull| hull.points().len()).sum();
        let size = vec![("parts", parts.len()), ("vertices", vertices)];
        Ok(parry_pair(scene, SharedShape::compound(parts), size))
    }
}
