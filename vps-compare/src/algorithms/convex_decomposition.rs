use rapier3d::math::{Pose, Vector};
use rapier3d::parry::shape::SharedShape;
use rapier3d::parry::transformation::vhacd::{VHACD, VHACDParameters};
use serde::{Deserialize, Serialize};
use vps_build::Mesh;

use crate::algorithm::{AssetSource, CollisionAlgorithm, PrepareError, Sizes};
use crate::algorithms::parry_pair::parry_pair;
use crate::algorithms::simplify_hull::simplify_hull;
use crate::precision::single;
use crate::prepared::{Prepared, Size};
use crate::scene::Scene;

/// Convex parts by VHACD, each a hull of limited size: parry's counterpart of the HACD in the
/// paper's comparison.
///
/// parry's VHACD splits, but does not merge as the original does, and returns more parts than
/// requested. They are merged here, those with the least added volume first, until there are few
/// enough.
#[derive(Clone, Copy, Debug, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct ConvexDecomposition {
    /// Largest number of parts.
    pub parts: usize,
    /// Largest number of vertices of a part, 42 or more.
    pub vertices: usize,
    /// Voxels along the longest side in VHACD.
    pub resolution: u32,
}

impl Default for ConvexDecomposition {
    /// Eight parts of up to 100 vertices, found among 64 voxels along the longest side.
    fn default() -> Self {
        Self {
            parts: 8,
            vertices: 100,
            resolution: 64,
        }
    }
}

impl CollisionAlgorithm for ConvexDecomposition {
    fn about(&self) -> &'static str {
        "Convex parts for each mesh, by VHACD"
    }

    fn label(&self) -> &'static str {
        "convex decomposition"
    }

    fn color(&self) -> [u8; 3] {
        [0xcc, 0x79, 0xa7]
    }

    fn check(&self) -> Result<(), String> {
        if self.vertices < 42 {
            return Err("vertices must be at least 42".into());
        }
        Ok(())
    }

    fn set_sizes(&mut self, sizes: &Sizes) {
        self.parts = sizes.parts;
    }

    fn prepare_with(
        &self,
        scene: &Scene<'_>,
        _assets: &AssetSource<'_>,
    ) -> Result<Prepared, PrepareError> {
        parry_pair(scene, |mesh| self.parts_of(mesh))
    }
}

impl ConvexDecomposition {
    fn parts_of(&self, mesh: &Mesh) -> Result<(SharedShape, Size), PrepareError> {
        let vertices = single(mesh.vertices());
        let parameters = VHACDParameters {
            max_convex_hulls: self.parts as u32,
            resolution: self.resolution,
            ..VHACDParameters::default()
        };
        let triangles = mesh.triangles();
        let decomposition = VHACD::decompose(&parameters, &vertices, triangles, true);
        let split = decomposition.compute_exact_convex_hulls(&vertices, triangles);
        let split = split
            .into_iter()
            .filter_map(|(points, _)| Hull::new(&points));
        let parts: Vec<_> = merge_parts(split.collect(), self.parts)
            .into_iter()
            .filter_map(|hull| {
                let few = simplify_hull(&hull.points, self.vertices)?;
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
        Ok((SharedShape::compound(parts), size))
    }
}

/// A convex part.
#[derive(Clone)]
struct Hull {
    points: Vec<Vector>,
    volume: f32,
}

impl Hull {
    /// `None` if the points lie in a plane.
    fn new(points: &[Vector]) -> Option<Self> {
        let shape = SharedShape::convex_hull(points)?;
        Some(Self {
            points: shape.as_convex_polyhedron()?.points().to_vec(),
            volume: shape.mass_properties(1.0).mass(),
        })
    }
}

/// Merges the pair of parts whose common hull adds the least volume, until there are at most
/// `max_parts`.
fn merge_parts(mut parts: Vec<Hull>, max_parts: usize) -> Vec<Hull> {
    while parts.len() > max_parts.max(1) {
        let mut best: Option<(f32, usize, usize, Hull)> = None;
        for a in 0..parts.len() {
            for b in a + 1..parts.len() {
                let both = [parts[a].points.as_slice(), &parts[b].points].concat();
                let Some(hull) = Hull::new(&both) else {
                    continue;
                };
                let added = hull.volume - parts[a].volume - parts[b].volume;
                if best.as_ref().is_none_or(|(least, ..)| added < *least) {
                    best = Some((added, a, b, hull));
                }
            }
        }
        let Some((_, a, b, hull)) = best else {
            break;
        };
        parts[a] = hull;
        parts.remove(b);
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_are_merged_first() {
        let cube = single(Mesh::cuboid([1.0; 3]).unwrap().vertices());
        let at = |x: f32| {
            let moved: Vec<_> = cube.iter().map(|p| *p + Vector::X * x).collect();
            Hull::new(&moved).unwrap()
        };
        let parts = vec![at(0.0), at(5.0), at(1.0)];
        let two = merge_parts(parts.clone(), 2);
        assert_eq!(two.len(), 2);
        assert!((two[0].volume - 2.0).abs() < 1e-5 && (two[1].volume - 1.0).abs() < 1e-5);
        assert!((merge_parts(parts, 1)[0].volume - 6.0).abs() < 1e-5);
    }
}
