use vps_core::{Aabb, Accuracy, Asset, Grid, GridError, Store, TreeError, Voxelmap, VoxelmapError};

use crate::bends::bends;
use crate::bvh::Bvh;
use crate::distance::{Exact, by_gradient_walk};
use crate::flat::refuse_sheet;
use crate::layers::layers;
use crate::mass::{mass_of_field, mass_of_mesh};
use crate::solid::{Repairs, Sign, Solid, solid};
use crate::sparse::{Coding, Source, Tolerance, sparse};
use crate::thin_walls::ThinWalls;
use crate::{Mesh, MeshError, cluster, frame, sample};

/// How fine the voxels are.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Resolution {
    /// Edge of a voxel in metres.
    VoxelSize(f64),
    /// Voxels along the longest side of the mesh.
    VoxelsAlongLongest(u32),
    /// As [`VoxelsAlongLongest(100)`](Self::VoxelsAlongLongest), and finer where walls are thinner
    /// than such a voxel, as far as a quarter of the memory limit allows (see [`ThinWalls`]).
    #[default]
    Auto,
}

/// Voxels along the longest side where no wall is thin.
const AUTO_VOXELS: u32 = 100;

/// How many points a pointshell gets (section 2.1.2).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PointCount {
    /// As many as this, to within 2 %.
    About(u32),
    /// As many as there are with this distance in metres between any two, but for those on the two
    /// sides of a thin wall. No place of the surface is further than 2.23 times as much from a
    /// point.
    Spacing(f64),
}

/// What the values of the voxelmap mean (section 2.1.1).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// 16-bit layers, one voxel size apart.
    Layers,
    /// 16-bit distances in metres truncated to this many decimal places (eq. 1), or to as many as
    /// fit.
    Distances(Option<i32>),
    /// 32-bit floating-point distances in metres.
    Floats,
}

/// How the point of the mesh that is closest to a voxel is found (section 2.1.1).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ClosestPoints {
    /// Among all triangles.
    #[default]
    Exact,
    /// As in the paper: on the triangle closest to the surface voxel that is reached by following
    /// the gradient of the layered map.
    GradientWalk,
}

/// How points are put into clusters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Clustering {
    /// From the top down: cut in halves across the longest direction, so that all clusters of a
    /// level have about as many points.
    #[default]
    Halves,
    /// As in the paper (section 2.1.2): from the leaves up, the nearest K together.
    Nearest {
        /// Where it starts.
        seed: u64,
    },
}

/// Whether all voxels have a value stored. A sparse map takes a fraction of the memory. Queries near
/// flat surfaces take as long on it, those of a body that is deep inside several times as long.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Density {
    /// Up to [`DENSE_VOXELS`] voxels.
    #[default]
    Auto,
    /// All.
    Dense,
    /// Only those that cannot be interpolated to within one voxel size.
    Sparse,
}

/// Up to how many voxels a map is dense unless asked otherwise.
pub const DENSE_VOXELS: usize = 1 << 16;

/// Up to how many voxels from the surface every voxel is stored as it is.
pub(crate) const BAND: f64 = 4.0;

/// What to build.
#[derive(Clone, Debug, PartialEq)]
pub struct BuildOptions {
    /// How fine the voxels are.
    pub resolution: Resolution,
    /// Outer layers around the box of the mesh, at least 1.
    pub margin: u32,
    /// How many points the pointshell gets.
    pub points: PointCount,
    /// Children of a cluster K, at least 2.
    pub branching: u32,
    /// How clusters are made.
    pub clustering: Clustering,
    /// What the voxels hold.
    pub encoding: Encoding,
    /// How distances are found.
    pub closest_points: ClosestPoints,
    /// Whether all voxels are stored.
    pub density: Density,
    /// Which side of a triangle is the inside.
    pub sign: Sign,
    /// The most memory voxels and points may take while they are made, in bytes.
    pub memory_limit: u64,
}

impl Default for BuildOptions {
    /// 100 voxels along the longest side, or more for thin walls, with a margin of 4, 10 000 points,
    /// K = 4, distances.
    fn default() -> Self {
        Self {
            resolution: Resolution::Auto,
            margin: 4,
            points: PointCount::About(10_000),
            branching: 4,
            clustering: Clustering::default(),
            encoding: Encoding::Distances(None),
            closest_points: ClosestPoints::default(),
            density: Density::default(),
            sign: Sign::default(),
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
    /// Points need a distance.
    #[error("the spacing of points must be positive and finite, not {0} m")]
    Spacing(f64),
    /// Points that would be too many.
    #[error("with {spacing_m} m between them there would be about {points} points: choose more")]
    TooManyPoints {
        /// The distance asked for.
        spacing_m: f64,
        /// How many points there would be.
        points: u64,
    },
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
    /// Too many triangles of parts that overlap.
    #[error(
        "parts of the mesh overlap or touch, and the union of {triangles} triangles needs \
         {needed_mib} MiB to find, the limit is {limit_mib} MiB: choose a higher limit, or simplify \
         the mesh"
    )]
    UnionMemory {
        /// All of the mesh.
        triangles: usize,
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
    /// All in one plane.
    #[error(
        "the mesh is a sheet, {} m thick and {} m long: give it a thickness, or look for a vertex \
         that is far off", *thickness_m as f32, *longest_m as f32
    )]
    Sheet {
        /// Between the two planes that hold all of it.
        thickness_m: f64,
        /// The longest side of the box around it.
        longest_m: f64,
    },
    /// Numbers that overflow or vanish in 32 bits.
    #[error(
        "volume {volume_m3:e} m³ or inertia of the solid does not fit 32 bits: is a vertex far off, \
         or the scale wrong?"
    )]
    Size {
        /// Its volume.
        volume_m3: f64,
    },
    /// A solid inside out, or none.
    #[error(
        "the mesh encloses no volume: it may be a sheet, or its faces may be turned at random \
         (see `vps-build inspect`; `--sign fill` does not mind how they are turned)"
    )]
    NotSolid,
    /// What repairs leave is no mesh.
    #[error(transparent)]
    Mesh(#[from] MeshError),
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

/// Bytes a voxel takes around the mesh: its place and winding number.
const BYTES_PER_PLACE: f64 = 5.0;

/// Bytes a voxel takes where all are stored: its layer, its penetration and its value.
const BYTES_PER_VOXEL: f64 = 2.0 + 4.0 + 4.0 + 2.0;

/// Bytes a voxel takes in a sparse map, while it is built, if the surface winds through a tenth of
/// all cells.
const BYTES_PER_SPARSE_VOXEL: f64 = 0.5;

/// Bytes a point takes until it is in its tree.
const BYTES_PER_POINT: f64 = 512.0;

/// An asset, and what had to be done to the mesh first.
#[derive(Clone, Debug)]
pub struct Built {
    /// Voxelmap, pointshell, tree and mass properties.
    pub asset: Asset<'static>,
    /// How the mesh was made a solid.
    pub repairs: Repairs,
    /// What is thinner than a voxel.
    pub thin_walls: ThinWalls,
}

/// Makes voxelmap, pointshell, tree and mass properties of a mesh; `on_stage` hears of every step.
/// The same mesh and options give the same asset, whatever the number of threads.
///
/// # Errors
/// When an option is out of range, the voxels need too much memory, or the mesh encloses nothing.
pub fn build(
    mesh: &Mesh,
    options: &BuildOptions,
    on_stage: &dyn Fn(Stage),
) -> Result<Built, BuildError> {
    if options.branching < 2 {
        return Err(BuildError::Branching(options.branching));
    }
    refuse_sheet(mesh)?;
    let points = most_points(mesh, options.points)?;
    let (mesh, origin) = frame::local(mesh, voxel_size(mesh, options)?);
    let mesh = mesh.as_ref();
    let mut grid = self::grid(mesh, options, points)?;
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
    let samples = sample::sample(&solid.mesh, options.points, &voxelmap);
    on_stage(Stage::Tree);
    let tree = cluster::build_tree(&samples, options.branching as usize, options.clustering)?;
    let areas = samples.areas.iter().map(|&area| f64::from(area));
    let points: Vec<_> = samples.positions.iter().copied().zip(areas).collect();
    let voxel_size = f64::from(grid.voxel_size());
    let thin_walls = ThinWalls::of(&solid.mesh, &bvh, &points, 0.0..voxel_size, Some(&voxelmap));
    Ok(Built {
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

/// What part of the memory limit is for voxels nobody asked for.
const AUTO_MEMORY: u64 = 4;

/// The grid for the thin walls of a solid, if there are some: as fine as they need, as far as a part
/// of the memory limit allows.
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
            memory_limit: options.memory_limit / AUTO_MEMORY,
            ..options.clone()
        };
        self::grid(mesh, &options, points)
    };
    let mut finest = coarsest;
    while of_size(0.9 * finest).is_ok() {
        finest *= 0.9;
    }
    // Walls that the finest voxels would be too large for are no reason for finer ones.
    let walls = ThinWalls::sampled(solid, bvh, finest..coarsest);
    let sufficient = walls.sufficient_voxel_m.map(|size| size.max(finest));
    sufficient.map(of_size).transpose()
}

/// How many points there may be.
fn most_points(mesh: &Mesh, points: PointCount) -> Result<f64, BuildError> {
    match points {
        PointCount::About(0) => Err(BuildError::Points),
        PointCount::About(count) => Ok(f64::from(count)),
        PointCount::Spacing(spacing) => {
            if !(spacing > 0.0 && spacing.is_finite()) {
                return Err(BuildError::Spacing(spacing));
            }
            let most = sample::about_count(mesh, spacing);
            if most > f64::from(u32::MAX >> 2) {
                return Err(BuildError::TooManyPoints {
                    spacing_m: spacing,
                    points: most as u64,
                });
            }
            Ok(most)
        }
    }
}

fn is_dense(density: Density, voxels: f64) -> bool {
    match density {
        Density::Auto => voxels <= DENSE_VOXELS as f64,
        Density::Dense => true,
        Density::Sparse => false,
    }
}

/// Edge of a voxel in metres.
pub(crate) fn voxel_size(mesh: &Mesh, options: &BuildOptions) -> Result<f64, BuildError> {
    let (low, high) = mesh.bounds();
    let longest = (high - low).max_element();
    let size = match options.resolution {
        Resolution::VoxelSize(size) => size,
        Resolution::VoxelsAlongLongest(0) => return Err(BuildError::NoVoxels),
        Resolution::VoxelsAlongLongest(n) => longest / f64::from(n),
        Resolution::Auto => longest / f64::from(AUTO_VOXELS),
    };
    if !(size > 0.0 && size.is_finite()) {
        return Err(BuildError::VoxelSize(size));
    }
    Ok(size)
}

pub(crate) fn grid(mesh: &Mesh, options: &BuildOptions, points: f64) -> Result<Grid, BuildError> {
    let (low, high) = mesh.bounds();
    let extents = high - low;
    let size = voxel_size(mesh, options)?;
    if options.margin == 0 {
        return Err(BuildError::Margin);
    }
    // A side that is a whole number of voxels long stays so in spite of rounding.
    let inner = (extents / size - 1e-6).ceil().max(glamx::DVec3::ONE);
    let dims = inner + 2.0 * f64::from(options.margin);
    let voxels = dims.element_product();
    let has_table = is_dense(options.density, voxels)
        || options.encoding == Encoding::Layers
        || options.closest_points == ClosestPoints::GradientWalk;
    let per_voxel = if has_table {
        BYTES_PER_VOXEL
    } else {
        BYTES_PER_SPARSE_VOXEL
    };
    let needed = voxels * per_voxel
        + (inner + 2.0).element_product() * BYTES_PER_PLACE
        + points * BYTES_PER_POINT;
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
    solid: &Solid<'_>,
    bvh: &Bvh,
    grid: Grid,
    options: &BuildOptions,
) -> Result<Voxelmap<'static>, BuildError> {
    let Solid { mesh, places, .. } = solid;
    let (low, high) = mesh.bounds();
    let bounds = grid.bounds();
    // Rounding may leave the mesh a hair outside of the grid's own numbers.
    let solid = Aabb {
        min: bounds.clamp(low.as_vec3()),
        max: bounds.clamp(high.as_vec3()),
    };
    let size = f64::from(grid.voxel_size());
    let is_dense = is_dense(options.density, grid.voxel_count() as f64);
    let exact;
    let table;
    let source = match (options.encoding, options.closest_points) {
        (Encoding::Layers, _) => {
            table = layers(&grid, places)
                .iter()
                .map(|&layer| f32::from(layer) * grid.voxel_size())
                .collect::<Vec<_>>();
            Source::Table(&table)
        }
        (_, ClosestPoints::GradientWalk) => {
            table = by_gradient_walk(mesh, bvh, &grid, places);
            Source::Table(&table)
        }
        (_, ClosestPoints::Exact) => {
            exact = Exact::new(bvh, &grid, places);
            if is_dense {
                table = exact.all();
                Source::Table(&table)
            } else {
                Source::Exact(&exact)
            }
        }
    };
    let lattice = source.lattice(&grid);
    let largest = lattice.largest(size);
    let coding = match options.encoding {
        Encoding::Layers => Coding::Layers(size),
        Encoding::Distances(precision) => Coding::Integers(lambda(precision, largest)?),
        Encoding::Floats => Coding::Floats,
    };
    // One truncated step, and the rounding of 32-bit coordinates.
    let largest_place = bounds.min.abs().max(bounds.max.abs()).length();
    let rounding = 8.0 * f64::from(f32::EPSILON * largest_place);
    let stored = match coding {
        Coding::Integers(lambda) | Coding::Layers(lambda) => lambda + rounding,
        Coding::Floats => rounding,
    };
    let interpolated = if is_dense {
        0.0
    } else {
        size.max(2.0 * stored)
    };
    let store = match source {
        Source::Table(table) if is_dense => Store::dense(grid.dims(), coding.all(table))?,
        _ => {
            let tolerance = Tolerance {
                error: interpolated - rounding,
                band: BAND * size,
                near: match options.encoding {
                    Encoding::Layers => 1e-6 * size,
                    Encoding::Distances(_) => coding.sigma(),
                    Encoding::Floats => 0.25 * rounding,
                },
            };
            sparse(&grid, &source, &lattice, coding, tolerance)?
        }
    };
    let is_exact = matches!(options.closest_points, ClosestPoints::Exact);
    let (near, far) = if is_exact && options.encoding != Encoding::Layers {
        (stored, interpolated.max(stored))
    } else {
        // The centre of layer n is between (n - 1/2) s and √3 (n + 1/2) s from the surface.
        let error = |layers: f64| (1.7321 * (layers + 0.5) - layers) * size + stored;
        (
            error(BAND),
            error((largest / size).max(BAND)) + interpolated,
        )
    };
    let accuracy = Accuracy {
        near_m: near as f32,
        far_m: far as f32,
        band_m: ((BAND - 0.01) * size) as f32,
    };
    let bends = bends(&store, (coding.sigma() / size) as f32);
    Ok(Voxelmap::new(
        grid,
        coding.sigma() as f32,
        solid,
        accuracy,
        store,
        bends.into(),
    )?)
}

/// Eq. 1: λ = 10^-p, with as many decimal places as distances up to `largest` leave in 16 bits.
fn lambda(precision: Option<i32>, largest: f64) -> Result<f64, BuildError> {
    let most = f64::from(i16::MAX) / largest.max(1e-30);
    let fitting = most.log10().floor() as i32;
    let precision = precision.unwrap_or(fitting);
    if precision > fitting {
        return Err(BuildError::Precision {
            precision,
            max_m: largest as f32,
            fitting,
        });
    }
    Ok(10.0_f64.powi(-precision))
}
