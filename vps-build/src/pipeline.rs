//! From a mesh to an asset, stage by stage.

use vps_core::{Asset, Grid};

use crate::error::BuildError;
use crate::field::voxelmap::voxelmap;
use crate::grid::{grid, voxel_size};
use crate::inspection::thin_walls::ThinWalls;
use crate::mesh::mass::{mass_of_field, mass_of_mesh};
use crate::mesh::sheet::reject_sheet;
use crate::mesh::{Mesh, frame};
use crate::options::{BuildOptions, Resolution};
use crate::shell::sample_surface;
use crate::shell::spacing::max_points;
use crate::shell::tree::build_tree;
use crate::solid::repair::Repairs;
use crate::solid::solid;
use crate::spatial::bvh::Bvh;

/// A stage of a build, for progress reports.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// The boundary of the solid.
    Solid,
    /// Surface voxels, fill and layers.
    Voxels,
    /// Distances.
    Distances,
    /// Points.
    Points,
    /// Clusters and balls.
    Tree,
}

/// An asset, the repairs of its mesh, and its thin walls.
#[derive(Clone, Debug)]
pub struct BuildOutput {
    /// Voxelmap, pointshell, tree and mass properties.
    pub asset: Asset<'static>,
    /// Repairs that made a solid of the mesh.
    pub repairs: Repairs,
    /// Walls thinner than a voxel.
    pub thin_walls: ThinWalls,
}

/// Builds the asset of a mesh: voxelmap, pointshell, tree and mass properties. `on_stage` is called at
/// the start of each stage. The same mesh and options give the same asset, whatever the number of
/// threads.
///
/// # Errors
/// When an option is out of range, the voxels need too much memory, or the mesh encloses nothing.
pub fn build(
    mesh: &Mesh,
    options: &BuildOptions,
    on_stage: &dyn Fn(Stage),
) -> Result<BuildOutput, BuildError> {
    if options.branching < 2 {
        return Err(BuildError::Branching(options.branching));
    }
    reject_sheet(mesh)?;
    let points = max_points(mesh, options.points)?;
    let (mesh, origin) = frame::to_local(mesh, voxel_size(mesh, options)?);
    let mesh = mesh.as_ref();
    let mut grid = grid(mesh, options, points)?;
    on_stage(Stage::Solid);
    let mut solid = solid(mesh, options.sign, &grid, options.memory_limit)?;
    on_stage(Stage::Voxels);
    let bvh = Bvh::new(&solid.mesh);
    if options.resolution == Resolution::Auto
        && let Some(finer) = finer_grid(mesh, &solid.mesh, &bvh, &grid, options, points)?
    {
        grid = finer;
        solid = solid.on(mesh, options.sign, &grid, options.memory_limit)?;
    }
    on_stage(Stage::Distances);
    let voxelmap = voxelmap(&solid, &bvh, grid, options)?;
    let mass = if solid.is_closed {
        mass_of_mesh(&solid.mesh)?
    } else {
        mass_of_field(&voxelmap)?
    };
    on_stage(Stage::Points);
    let samples = sample_surface(&solid.mesh, options.points, &voxelmap);
    on_stage(Stage::Tree);
    let tree = build_tree(&samples, options.branching as usize, options.clustering)?;
    let areas = samples.areas.iter().map(|&area| f64::from(area));
    let points: Vec<_> = samples.positions.iter().copied().zip(areas).collect();
    let voxel_size = f64::from(grid.voxel_size());
    let thin_walls = ThinWalls::of(&solid.mesh, &bvh, &points, 0.0..voxel_size, Some(&voxelmap));
    Ok(BuildOutput {
        asset: Asset {
            origin: origin.to_array(),
            voxelmap,
            tree,
            mass,
        },
        repairs: solid.repairs,
        thin_walls,
    })
}

/// Divisor of the memory limit for a grid refined by [`Resolution::Auto`].
const AUTO_MEMORY_DIVISOR: u64 = 4;

/// A finer grid for the thin walls of a solid, if it has any: as fine as they need, within a part of
/// the memory limit.
fn finer_grid(
    mesh: &Mesh,
    solid: &Mesh,
    bvh: &Bvh,
    coarse: &Grid,
    options: &BuildOptions,
    points: f64,
) -> Result<Option<Grid>, BuildError> {
    let coarsest = f64::from(coarse.voxel_size());
    let of_size = |size: f64| {
        let options = BuildOptions {
            resolution: Resolution::VoxelSize(size),
            memory_limit: options.memory_limit / AUTO_MEMORY_DIVISOR,
            ..options.clone()
        };
        grid(mesh, &options, points)
    };
    let mut finest = coarsest;
    while of_size(0.9 * finest).is_ok() {
        finest *= 0.9;
    }
    // Walls too thin for the finest voxels do not count.
    let walls = ThinWalls::sampled(solid, bvh, finest..coarsest);
    let sufficient = walls.sufficient_voxel_m.map(|size| size.max(finest));
    sufficient.map(of_size).transpose()
}
