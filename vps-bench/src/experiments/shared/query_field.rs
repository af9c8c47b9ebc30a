//! Pointshells, and the boxes whose fields they are put into.

use vps_build::{BuildOptions, CachedAsset, Density, Mesh};
use vps_core::{Cuboid, Vec3};

use crate::harness::context::Context;

/// How a box is a distance field.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) enum QueryField {
    /// The exact box.
    Cuboid,
    /// A voxelmap that stores every voxel.
    Dense,
    /// A voxelmap that stores voxels near the surface.
    Sparse,
}

impl QueryField {
    pub(crate) const ALL: [Self; 3] = [Self::Cuboid, Self::Dense, Self::Sparse];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Cuboid => "cuboid",
            Self::Dense => "dense",
            Self::Sparse => "sparse",
        }
    }

    /// Which voxels are stored; `None` for the exact box.
    pub(crate) fn density(self) -> Option<Density> {
        match self {
            Self::Cuboid => None,
            Self::Dense => Some(Density::Dense),
            Self::Sparse => Some(Density::Sparse),
        }
    }
}

/// The exact box with these edge lengths in metres, around the origin.
pub(crate) fn cuboid(extents_m: [f64; 3]) -> Cuboid {
    Cuboid::new(Vec3::from_array(extents_m.map(|edge| 0.5 * edge as f32)))
}

/// The pointshell of an algorithm of the method `vps`.
pub(crate) fn shell(
    context: &Context,
    algorithm: &str,
    mesh: &Mesh,
) -> Result<CachedAsset, String> {
    asset(
        context,
        mesh,
        &context.algorithms.vps(algorithm)?.build_options(),
    )
}

/// The voxelmap of a box with these edge lengths around the origin, with voxels as those an algorithm
/// of the method `vps` has for its ground.
pub(crate) fn voxelmap_of_box(
    context: &Context,
    algorithm: &str,
    extents_m: [f64; 3],
    density: Density,
) -> Result<CachedAsset, String> {
    let options = context.algorithms.vps(algorithm)?.box_options();
    let options = options.ok_or_else(|| format!("`{algorithm}` has no ground_voxel_size_m"))?;
    let mesh = Mesh::cuboid(extents_m).map_err(|e| e.to_string())?;
    asset(context, &mesh, &BuildOptions { density, ..options })
}

/// The asset of a mesh, from the cache or built now.
pub(crate) fn asset(
    context: &Context,
    mesh: &Mesh,
    options: &BuildOptions,
) -> Result<CachedAsset, String> {
    let cached = context.assets.get(mesh, options, &|_| ());
    cached.map_err(|e| e.to_string())
}
