//! Walls thinner than a voxel.

use std::ops::Range;

use glamx::DVec3;
use rayon::prelude::*;
use vps_core::{DistanceField, Voxelmap};

use crate::mesh::Mesh;
use crate::mesh::triangle::{normal, width};
use crate::shell::poisson::poisson_sample;
use crate::shell::spacing::spacing_for;
use crate::solid::self_contact::gap_tolerance;
use crate::spatial::bvh::Bvh;

/// Fraction of a surface with walls thinner than a voxel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ThinWalls {
    /// Fraction of the surface, from 0 to 1, with a wall behind it thinner than a voxel.
    pub fraction: f64,
    /// Fraction of the surface, from 0 to 1, with a wall behind it whose middle the voxelmap has
    /// outside.
    pub lost_fraction: f64,
    /// Voxel size in metres at which the middle of such walls, except the thinnest twentieth, keeps
    /// at least half of its depth. None without thin walls.
    pub sufficient_voxel_m: Option<f64>,
}

/// Fraction of thin walls that may be thinner still: sharp edges have no thickness at their tip.
const NEGLECTED_FRACTION: f64 = 0.05;

/// Least cosine between the normals of the two sides of a wall, reversed: 25 degrees.
const PARALLEL_COSINE: f64 = 0.9;

/// Approximate number of points at which walls are looked for.
const SAMPLES: f64 = 10_000.0;

impl ThinWalls {
    /// Thin walls of a mesh without a pointshell.
    pub(crate) fn sampled(mesh: &Mesh, bvh: &Bvh, thin: Range<f64>) -> Self {
        let spacing = spacing_for(mesh, SAMPLES);
        if spacing == 0.0 {
            return Self::default();
        }
        let points = poisson_sample(mesh, spacing).points;
        let points: Vec<_> = points.into_iter().map(|point| (point, 1.0)).collect();
        Self::of(mesh, bvh, &points, thin, None)
    }

    /// Thin walls at points of a surface, each with its area. Walls count whose thickness in metres
    /// is in `thin`.
    pub(crate) fn of(
        mesh: &Mesh,
        bvh: &Bvh,
        points: &[(DVec3, f64)],
        thin: Range<f64>,
        map: Option<&Voxelmap<'_>>,
    ) -> Self {
        let walls: Vec<Option<Wall>> = points
            .par_iter()
            .map(|&(point, _)| wall_behind(mesh, bvh, point, &thin))
            .collect();
        let walls = || points.iter().zip(&walls);
        let thin = walls().filter_map(|(&(_, area), wall)| Some((wall.as_ref()?, area)));
        let mut thin: Vec<(&Wall, f64)> = thin.collect();
        // From 0: the sum of nothing is -0.
        let sum = |areas: &mut dyn Iterator<Item = f64>| areas.fold(0.0, |sum, area| sum + area);
        let total = sum(&mut points.iter().map(|(_, area)| *area));
        let thin_area = sum(&mut thin.iter().map(|(_, area)| *area));
        let is_lost = |wall: &Wall| {
            let field = map.map(Voxelmap::trilinear);
            field.is_some_and(|f| f.signed_distance(wall.middle.as_vec3()) >= 0.0)
        };
        let lost = thin.iter().filter(|(wall, _)| is_lost(wall));
        let lost = sum(&mut lost.map(|(_, area)| *area));
        thin.sort_by(|a, b| a.0.thickness.total_cmp(&b.0.thickness));
        let mut passed = 0.0;
        let enough = thin.iter().find(|(_, area)| {
            passed += area;
            passed > NEGLECTED_FRACTION * thin_area
        });
        Self {
            fraction: thin_area / total,
            lost_fraction: lost / total,
            sufficient_voxel_m: enough.map(|(wall, _)| 0.5 * wall.thickness),
        }
    }
}

/// The wall behind a point of a surface.
struct Wall {
    /// Distance of the other side in metres.
    thickness: f64,
    middle: DVec3,
}

/// The wall behind a point of a surface, if its thickness is in a range. Sphere-traced along the
/// normal.
fn wall_behind(mesh: &Mesh, bvh: &Bvh, point: DVec3, thin: &Range<f64>) -> Option<Wall> {
    let normal = |t: u32| normal(mesh.corners(t as usize));
    // Thinner than a gap: no wall.
    let least = gap_tolerance(mesh);
    // Slivers have no reliable normal.
    let is_sliver = |t: u32| width(mesh.corners(t as usize)) <= least;
    let front = bvh.closest(point, 0);
    if is_sliver(front.triangle) {
        return None;
    }
    let outward = normal(front.triangle);
    let (mut depth, mut guess) = (least, front.triangle);
    while depth < thin.end {
        let at = front.point - outward * depth;
        let closest = bvh.closest(at, guess);
        guess = closest.triangle;
        if closest.distance <= least
            && normal(closest.triangle).dot(outward) < -PARALLEL_COSINE
            && !is_sliver(closest.triangle)
        {
            return (depth >= thin.start).then(|| Wall {
                thickness: depth,
                middle: front.point - outward * (0.5 * depth),
            });
        }
        depth += closest.distance.max(least);
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::triangle::{area, middle};

    fn of(mesh: &Mesh, voxel_size: f64) -> ThinWalls {
        let middle = |t: usize| middle(mesh.corners(t));
        let area = |t: usize| area(mesh.corners(t));
        let count = mesh.triangles().len();
        let points: Vec<_> = (0..count).map(|t| (middle(t), area(t))).collect();
        ThinWalls::of(mesh, &Bvh::new(mesh), &points, 0.0..voxel_size, None)
    }

    #[test]
    fn a_plate_is_thin_below_its_thickness() {
        let plate = Mesh::cuboid([1.0, 0.01, 1.0]).unwrap();
        let thin = of(&plate, 0.02);
        assert!((thin.fraction - 2.0 / 2.04).abs() < 1e-9, "{thin:?}");
        let enough = thin.sufficient_voxel_m.unwrap();
        assert!((enough - 0.005).abs() < 1e-5, "{enough}");
        assert_eq!(of(&plate, 0.009), ThinWalls::default());
    }

    /// Sharp edges and gaps do not count as thin walls.
    #[test]
    fn edges_and_gaps_are_no_walls() {
        let box_ = Mesh::cuboid([1.0, 0.1, 1.0])
            .unwrap()
            .subdivided()
            .subdivided();
        assert_eq!(of(&box_, 0.09), ThinWalls::default());
        let shifted = box_.vertices().iter().map(|&v| v + DVec3::Y * 0.11);
        let vertices: Vec<_> = box_.vertices().iter().copied().chain(shifted).collect();
        let first = box_.vertices().len() as u32;
        let second = box_.triangles().iter().map(|t| t.map(|v| v + first));
        let triangles: Vec<_> = box_.triangles().iter().copied().chain(second).collect();
        let two = Mesh::new(&vertices, &triangles).unwrap();
        assert_eq!(of(&two, 0.09), ThinWalls::default());
    }
}
