use rayon::prelude::*;
use vps_core::{Aabb, Accuracy, Asset, Grid, GridError, TreeError, Voxelmap, VoxelmapError};

use crate::layers::{layers, places};
use crate::mass::mass_properties;
use crate::{Mesh, cluster, distance, sample};

/// How fine the voxels are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Resolution {
    /// Edge of a voxel in metres.
    VoxelSize(f64),
    /// Voxels along the longest side of the mesh.
    VoxelsAlongLongest(u32),
}

/// What the integers of the voxelmap mean (section 2.1.1).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// Layers, one voxel size apart.
    Layers,
    /// Distances in metres truncated to this many decimal places (eq. 1), or to as many as fit.
    Distances(Option<i32>),
}

/// What to build.
#[derive(Clone, Debug, PartialEq)]
pub struct BuildOptions {
    /// How fine the voxels are.
    pub resolution: Resolution,
    /// Outer layers around the box of the mesh, at least 1.
    pub margin: u32,
    /// About how many points the pointshell gets.
    pub points: u32,
    /// Children of a cluster K, at least 2.
    pub branching: u32,
    /// What the voxels hold.
    pub encoding: Encoding,
    /// Where the clustering starts.
    pub seed: u64,
    /// The most memory voxels and points may take while they are made, in bytes.
    pub memory_limit: u64,
}

impl Default for BuildOptions {
    /// 100 voxels along the longest side with a margin of 4, 10 000 points, K = 4, distances.
    fn default() -> Self {
        Self {
            resolution: Resolution::VoxelsAlongLongest(100),
            margin: 4,
            points: 10_000,
            branching: 4,
            encoding: Encoding::Distances(None),
            seed: 1,
            memory_limit: 4 << 30,
        }
    }
}

/// Why an asset cannot be built.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum BuildError {
    /// A voxel needs a size.
    #[error("the voxel size must be positive and finite, not {0} m")]
    VoxelSize(f64),
    /// Voxels along the longest side.
    #[error("the longest side needs at least one voxel")]
    NoVoxels,
    /// The fill needs room around the mesh.
    #[error("the margin must be at least 1 layer")]
    Margin,
    /// A shell needs points.
    #[error("the number of points must be at least 1")]
    Points,
    /// A tree that does not shrink never ends.
    #[error("the branching K must be at least 2, not {0}")]
    Branching(u32),
    /// Too fine.
    #[error(
        "{0} x {1} x {2} voxels and the points need {needed_mib} MiB to build, the limit is \
         {limit_mib} MiB: choose larger voxels, a smaller margin, fewer points or a higher limit",
        dims[0], dims[1], dims[2]
    )]
    Memory {
        /// Voxels along each axis.
        dims: [u64; 3],
        /// What they take.
        needed_mib: u64,
        /// What they may take.
        limit_mib: u64,
    },
    /// Distances that do not fit 16 bits.
    #[error(
        "distances of up to {max_m} m do not fit 16 bits with {precision} decimal places: choose \
         {fitting} or fewer"
    )]
    Precision {
        /// Decimal places asked for.
        precision: i32,
        /// The largest distance.
        max_m: f32,
        /// The most decimal places that fit.
        fitting: i32,
    },
    /// No solid.
    #[error(
        "the mesh is not closed: {0} edges have no triangle on their other side that faces the \
         same way (see `vps-build inspect`)"
    )]
    Open(usize),
    /// A solid inside out.
    #[error("the mesh encloses no volume: do its triangles face outwards?")]
    NotSolid,
    /// The grid was refused.
    #[error(transparent)]
    Grid(#[from] GridError),
    /// The voxelmap was refused.
    #[error(transparent)]
    Voxelmap(#[from] VoxelmapError),
    /// The tree was refused.
    #[error(transparent)]
    Tree(#[from] TreeError),
}

/// A step of a build, told to whoever shows progress.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Surface voxels, fill and layers.
    Voxels,
    /// Distances.
    Distances,
    /// Points.
    Points,
    /// Clusters and balls.
    Tree,
}

/// Bytes a voxel takes while distances are made: its place, its penetration, the closest surface
/// voxel along z and its value.
const BYTES_PER_VOXEL: u64 = 1 + 4 + 2 + 2;

/// Bytes a point takes until it is in its tree.
const BYTES_PER_POINT: u64 = 512;

/// Makes voxelmap, pointshell, tree and mass properties of a closed mesh; `on_stage` hears of
/// every step. The same mesh and options give the same asset, whatever the number of threads.
///
/// # Errors
/// When an option is out of range, the voxels need too much memory, or the mesh is no solid.
pub fn build(
    mesh: &Mesh,
    options: &BuildOptions,
    on_stage: &dyn Fn(Stage),
) -> Result<Asset<'static>, BuildError> {
    if options.points == 0 {
        return Err(BuildError::Points);
    }
    if options.branching < 2 {
        return Err(BuildError::Branching(options.branching));
    }
    let grid = grid(mesh, options)?;
    let mass = mass_properties(mesh)?;
    on_stage(Stage::Voxels);
    let voxelmap = voxelmap(mesh, grid, options.encoding, on_stage)?;
    on_stage(Stage::Points);
    let samples = sample::sample(mesh, options.points, &voxelmap);
    on_stage(Stage::Tree);
    let tree = cluster::build_tree(&samples, options.branching as usize, options.seed)?;
    Ok(Asset {
        voxelmap,
        tree,
        mass,
    })
}

fn grid(mesh: &Mesh, options: &BuildOptions) -> Result<Grid, BuildError> {
    let (low, high) = mesh.bounds();
    let extents = high - low;
    let size = match options.resolution {
        Resolution::VoxelSize(size) => size,
        Resolution::VoxelsAlongLongest(0) => return Err(BuildError::NoVoxels),
        Resolution::VoxelsAlongLongest(n) => extents.max_element() / f64::from(n),
    };
    if !(size > 0.0 && size.is_finite()) {
        return Err(BuildError::VoxelSize(size));
    }
    if options.margin == 0 {
        return Err(BuildError::Margin);
    }
    // A side that is a whole number of voxels long stays so in spite of rounding.
    let margins = 2.0 * f64::from(options.margin);
    let dims = (extents / size - 1e-6).ceil().max(glamx::DVec3::ONE) + margins;
    let slices = dims.z.min(distance::slices_at_once() as f64);
    let needed = dims.element_product() * BYTES_PER_VOXEL as f64
        + dims.x * dims.y * slices * distance::BYTES_PER_VOXEL_AT_ONCE as f64
        + f64::from(options.points) * BYTES_PER_POINT as f64;
    if needed > options.memory_limit as f64 || dims.max_element() >= f64::from(u16::MAX) {
        return Err(BuildError::Memory {
            dims: dims.to_array().map(|n| n as u64),
            needed_mib: (needed / f64::from(1 << 20)).ceil() as u64,
            limit_mib: options.memory_limit >> 20,
        });
    }
    let origin = low.midpoint(high) - dims * (0.5 * size);
    let dims = dims.to_array().map(|n| n as u32);
    Ok(Grid::new(origin.as_vec3(), size as f32, dims)?)
}

fn voxelmap(
    mesh: &Mesh,
    grid: Grid,
    encoding: Encoding,
    on_stage: &dyn Fn(Stage),
) -> Result<Voxelmap<'static>, BuildError> {
    let places = places(mesh, &grid);
    let (low, high) = mesh.bounds();
    let bounds = grid.bounds();
    // Rounding may leave the mesh a hair outside of the grid's own numbers.
    let solid = Aabb {
        min: bounds.clamp(low.as_vec3()),
        max: bounds.clamp(high.as_vec3()),
    };
    let size = grid.voxel_size();
    let (values, sigma, accuracy) = match encoding {
        Encoding::Layers => {
            // The centre of layer n is between (n - 1/2) s and √3 (n + 1/2) s from the surface.
            let error = |layers: f32| (1.7321 * (layers + 0.5) - layers) * size;
            let values = layers(&grid, &places);
            let most = values.iter().map(|v| v.unsigned_abs()).max().unwrap_or(0);
            let band = distance::BAND as f32;
            let accuracy = Accuracy {
                near_m: error(band),
                far_m: error(f32::from(most).max(band)),
                band_m: band * size,
            };
            (values, size, accuracy)
        }
        Encoding::Distances(precision) => {
            on_stage(Stage::Distances);
            let penetrations = distance::penetrations(mesh, &grid, &places);
            let (values, lambda) = truncated(&penetrations, precision)?;
            // One truncated step, and the rounding of 32-bit coordinates.
            let near_m = lambda + 8.0 * f32::EPSILON * bounds.extents().length();
            let accuracy = Accuracy {
                near_m,
                far_m: near_m + distance::FAR_ERROR as f32 * size,
                band_m: (distance::BAND as f32 - 0.1) * size,
            };
            (values, lambda, accuracy)
        }
    };
    Ok(Voxelmap::new(grid, sigma, solid, accuracy, values.into())?)
}

/// Eq. 1: distances as integers in steps of λ = 10^-p, truncated towards zero.
fn truncated(penetrations: &[f32], precision: Option<i32>) -> Result<(Vec<i16>, f32), BuildError> {
    let max_m = penetrations
        .par_iter()
        .map(|p| p.abs())
        .reduce(|| 0.0, f32::max);
    let most = f64::from(i16::MAX) / f64::from(max_m.max(1e-30));
    let fitting = most.log10().floor() as i32;
    let precision = precision.unwrap_or(fitting);
    if precision > fitting {
        return Err(BuildError::Precision {
            precision,
            max_m,
            fitting,
        });
    }
    let lambda = 10.0_f64.powi(-precision);
    let values = penetrations
        .par_iter()
        .map(|&p| (f64::from(p) / lambda) as i16)
        .collect();
    Ok((values, lambda as f32))
}
