use rapier3d::math::Vector;
use rapier3d::parry::shape::SharedShape;
use serde::{Deserialize, Serialize};
use vps_build::Mesh;

use crate::algorithm::{AssetSource, CollisionAlgorithm, PrepareError};
use crate::algorithms::parry_pair::parry_pair;
use crate::precision::single;
use crate::prepared::Prepared;
use crate::scene::Scene;

/// One convex hull of the mesh's support points along 42 directions, those of an icosahedron
/// divided once: the hull `btShapeHull` makes in the paper's comparison.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize)]
pub struct ConvexHull;

impl CollisionAlgorithm for ConvexHull {
    fn about(&self) -> &'static str {
        "A convex hull of up to 42 vertices for each mesh"
    }

    fn label(&self) -> &'static str {
        "convex hull"
    }

    fn color(&self) -> [u8; 3] {
        [0x00, 0x9e, 0x73]
    }

    fn prepare_with(
        &self,
        scene: &Scene<'_>,
        _assets: &AssetSource<'_>,
    ) -> Result<Prepared, PrepareError> {
        parry_pair(scene, |mesh| {
            let points = support_points(&single(mesh.vertices()));
            let no_volume = PrepareError::NoVolume("convex hull");
            let shape = SharedShape::convex_hull(&points).ok_or(no_volume)?;
            let hull = shape.as_convex_polyhedron();
            let vertices = hull.map_or(0, |hull| hull.points().len());
            Ok((shape, vec![("vertices", vertices)]))
        })
    }
}

/// The support points along 42 evenly distributed directions, each once.
pub(super) fn support_points(points: &[Vector]) -> Vec<Vector> {
    let directions = Mesh::icosphere(1.0, 1).expect("a ball of radius one");
    let mut found: Vec<Vector> = Vec::new();
    for direction in single(directions.vertices()) {
        let along = |p: &&Vector| direction.dot(**p);
        let furthest = points.iter().max_by(|a, b| along(a).total_cmp(&along(b)));
        found.extend(furthest.filter(|p| !found.contains(p)));
    }
    found
}
