//! Walls that voxels are too large for.

use std::ops::Range;

use glamx::DVec3;
use rayon::prelude::*;
use vps_core::{DistanceField, Voxelmap};

use crate::Mesh;
use crate::bvh::Bvh;
use crate::sample::{about_spacing, spread};
use crate::solid::self_contact::gap;
use crate::triangle::{normal, width};

/// How much of a surface stands for walls thinner than a voxel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ThinWalls {
    /// Share of the surface, from 0 to 1, behind which the wall is thinner than a voxel.
    pub share: f64,
    /// Share of the surface behind which the middle of the wall is outside, for the voxelmap.
    pub lost_share: f64,
    /// Edge of a voxel in metres at which the middle of such walls keeps half of its depth or more;
    /// of all but a twentieth of them. None where there are no thin walls.
    pub sufficient_voxel_m: Option<f64>,
}

/// The share of thin walls that may be thinner still: what is sharp has no thickness at its tip.
const NEGLECTED: f64 = 0.05;

/// The two sides of a wall are parallel to within 25 degrees.
const PARALLEL: f64 = 0.9;

/// At how many points of a mesh walls are looked for, about.
const SAMPLES: f64 = 10_000.0;

impl ThinWalls {
    /// Of a mesh, before there is a pointshell.
    pub(crate) fn sampled(mesh: &Mesh, bvh: &Bvh, thin: Range<f64>) -> Self {
        let spacing = about_spacing(mesh, SAMPLES);
        if spacing == 0.0 {
            return Self::default();
        }
        let points = spread(mesh, spacing).points;
        let points: Vec<_> = points.into_iter().map(|point| (point, 1.0)).collect();
        Self::of(mesh, bvh, &points, thin, None)
    }

    /// At points of a surface, each standing for an area; walls count whose thickness in metres is in
    /// a range.
    pub(crate) fn of(
        mesh: &Mesh,
        bvh: &Bvh,
        points: &[(DVec3, f64)],
        thin: Range<f64>,
        map: Option<&Voxelmap<'_>>,
    ) -> Self {
        let walls: Vec<Option<Wall>> = points
            .par_iter()
            .map(|&(point, _)| wall(mesh, bvh, point, &thin))
            .collect();
        let walls = || points.iter().zip(&walls);
        let thin = walls().filter_map(|(&(_, area), wall)| Some((wall.as_ref()?, area)));
        let mut thin: Vec<(&Wall, f64)> = thin.collect();
        let total: f64 = points.iter().map(|(_, area)| area).sum();
        let thin_area: f64 = thin.iter().map(|(_, area)| area).sum();
        let is_lost = |wall: &Wall| {
            let field = map.map(Voxelmap::trilinear);
            field.is_some_and(|f| f.signed_distance(wall.middle.as_vec3()) >= 0.0)
        };
        let lost = thin.iter().filter(|(wall, _)| is_lost(wall));
        let lost: f64 = lost.map(|(_, area)| area).sum();
        thin.sort_by(|a, b| a.0.thickness.total_cmp(&b.0.thickness));
        let mut passed = 0.0;
        let enough = thin.iter().find(|(_, area)| {
            passed += area;
            passed > NEGLECTED * thin_area
        });
        Self {
            share: thin_area / total,
            lost_share: lost / total,
            sufficient_voxel_m: enough.map(|(wall, _)| 0.5 * wall.thickness),
        }
    }
}

/// What lies behind a point of a surface.
struct Wall {
    /// How far the other side is, in metres.
    thickness: f64,
    middle: DVec3,
}

/// The wall behind a point of a surface, if its thickness is in a range: found along the
/// normal, by steps as long as nothing is in the way.
fn wall(mesh: &Mesh, bvh: &Bvh, point: DVec3, thin: &Range<f64>) -> Option<Wall> {
    let normal = |t: u32| normal(mesh.corners(t as usize));
    // What is no gap is no wall.
    let least = gap(mesh);
    // The normal of a sliver means nothing.
    let is_sliver = |t: u32| width(mesh.corners(t as usize)) <= least;
    let front = bvh.closest(point, 0);
    if is_sliver(front.triangle) {
        return None;
    }
    let outward = normal(front.triangle);
    let (mut way, mut guess) = (least, front.triangle);
    while way < thin.end {
        let at = front.point - outward * way;
        let closest = bvh.closest(at, guess);
        guess = closest.triangle;
        if closest.distance <= least
            && normal(closest.triangle).dot(outward) < -PARALLEL
            && !is_sliver(closest.triangle)
        {
            return (way >= thin.start).then(|| Wall {
                thickness: way,
                middle: front.point - outward * (0.5 * way),
            });
        }
        way += closest.distance.max(least);
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::triangle::{area, middle};

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
        assert!((thin.share - 2.0 / 2.04).abs() < 1e-9, "{thin:?}");
        let enough = thin.sufficient_voxel_m.unwrap();
        assert!((enough - 0.005).abs() < 1e-5, "{enough}");
        assert_eq!(of(&plate, 0.009), ThinWalls::default());
    }

    /// What is sharp but no wall is not thin, nor is a gap.
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
