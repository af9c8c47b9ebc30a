//! The pointshell (section 2.1.2): Poisson-disk samples of the surface with inward normals and areas,
//! and the point-sphere tree over them.
//!
//! `poisson` samples the surface at a given spacing, `spacing` finds the spacing for a number of
//! points, `areas` divides the surface among the points. `tree` clusters them.

mod areas;
pub(crate) mod poisson;
pub(crate) mod spacing;
pub(crate) mod tree;

use glamx::DVec3;
use vps_core::{DistanceField, Vec3, Voxelmap};

use self::areas::voronoi_areas;
use self::poisson::{PoissonDisk, poisson_sample};
use self::spacing::sample_to_count;
use crate::mesh::Mesh;
use crate::options::PointCount;

/// Points on a surface, in the order of sampling.
pub(crate) struct SurfaceSamples {
    /// Positions in metres.
    pub(crate) positions: Vec<DVec3>,
    /// Unit inward normals.
    pub(crate) normals: Vec<Vec3>,
    /// Area of the surface each stands for, in m². Their sum is the area of the mesh.
    pub(crate) areas: Vec<f32>,
}

/// Samples the mesh. Normals are gradients of the field.
pub(crate) fn sample_surface(mesh: &Mesh, count: PointCount, map: &Voxelmap<'_>) -> SurfaceSamples {
    let disk = match count {
        PointCount::Spacing(spacing) => poisson_sample(mesh, spacing),
        PointCount::About(count) => sample_to_count(mesh, count),
    };
    let normals = inward_normals(&disk, map);
    let areas = voronoi_areas(mesh, &disk, &normals);
    SurfaceSamples {
        positions: disk.points,
        normals,
        areas,
    }
}

/// Unit inward normals: the gradient of the field at each point. Where it vanishes, in the middle of a
/// thin wall, the inward normal of the point's triangle.
fn inward_normals(disk: &PoissonDisk, map: &Voxelmap<'_>) -> Vec<Vec3> {
    let field = map.trilinear();
    let normal = |(point, outward): (&DVec3, &DVec3)| {
        let inward = field.inward_direction(point.as_vec3());
        if inward != Vec3::ZERO {
            return inward;
        }
        (-*outward).normalize_or(DVec3::X).as_vec3()
    };
    disk.points.iter().zip(&disk.normals).map(normal).collect()
}
