use rapier3d::math::Vector;
use rapier3d::parry::shape::SharedShape;
use vps_build::Mesh;

use crate::algorithm::{CollisionAlgorithm, PrepareError};
use crate::algorithms::parry_pair::parry_pair;
use crate::precision::single;
use crate::prepared::Prepared;
use crate::scene::Scene;

/// One convex hull of the mesh's support points along 42 directions, those of an icosahedron
/// divided once: the hull `btShapeHull` makes in the paper's comparison.
#[derive(Clone, Copy, Debug)]
pub struct ConvexHull;

impl CollisionAlgorithm for ConvexHull {
    fn prepare(&self, scene: &Scene<'_>) -> Result<Prepared, PrepareError> {
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
