//! Why an asset cannot be built.

use vps_core::{GridError, TreeError, VoxelmapError};

use crate::mesh::MeshError;

/// Why an asset cannot be built.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum BuildError {
    /// The voxel size is not positive and finite.
    #[error("the voxel size must be positive and finite, not {0} m")]
    VoxelSize(f64),
    /// No voxels along the longest side.
    #[error("the longest side needs at least one voxel")]
    NoVoxels,
    /// No layer of voxels around the mesh.
    #[error("the margin must be at least 1 layer")]
    Margin,
    /// No points for the pointshell.
    #[error("the number of points must be at least 1")]
    Points,
    /// The spacing is not positive and finite.
    #[error("the spacing of points must be positive and finite, not {0} m")]
    Spacing(f64),
    /// Too many points at the spacing.
    #[error("with {spacing_m} m between them there would be about {points} points: choose more")]
    TooManyPoints {
        /// The spacing asked for.
        spacing_m: f64,
        /// Estimated number of points.
        points: u64,
    },
    /// The branching is less than 2.
    #[error("the branching K must be at least 2, not {0}")]
    Branching(u32),
    /// The grid and the points exceed the memory limit.
    #[error(
        "{0} x {1} x {2} voxels and the points need {needed_mib} MiB to build, the limit is \
         {limit_mib} MiB: choose larger voxels, a smaller margin, fewer points or a higher limit",
        dims[0], dims[1], dims[2]
    )]
    Memory {
        /// Voxels along each axis.
        dims: [u64; 3],
        /// The memory they need.
        needed_mib: u64,
        /// The memory limit.
        limit_mib: u64,
    },
    /// The union of overlapping parts exceeds the memory limit.
    #[error(
        "parts of the mesh overlap or touch, and the union of {triangles} triangles needs \
         {needed_mib} MiB to find, the limit is {limit_mib} MiB: choose a higher limit, or simplify \
         the mesh"
    )]
    UnionMemory {
        /// Triangles of the mesh.
        triangles: usize,
        /// The memory they need.
        needed_mib: u64,
        /// The memory limit.
        limit_mib: u64,
    },
    /// Distances do not fit 16 bits.
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
    /// The mesh is not closed.
    #[error(
        "the mesh is not closed: {0} edges have no triangle on their other side that faces the \
         same way (see `vps-build inspect`)"
    )]
    Open(usize),
    /// The mesh lies in a plane.
    #[error(
        "the mesh is a sheet, {} m thick and {} m long: give it a thickness, or look for a vertex \
         that is far off", *thickness_m as f32, *longest_m as f32
    )]
    Sheet {
        /// Distance of the two planes that enclose it.
        thickness_m: f64,
        /// Longest side of its bounding box.
        longest_m: f64,
    },
    /// Volume or inertia overflow or underflow 32 bits.
    #[error(
        "volume {volume_m3:e} m³ or inertia of the solid does not fit 32 bits: is a vertex far off, \
         or the scale wrong?"
    )]
    Size {
        /// Its volume.
        volume_m3: f64,
    },
    /// The solid is inside out or empty.
    #[error(
        "the mesh encloses no volume: it may be a sheet, or its faces may be turned at random \
         (see `vps-build inspect`; `--sign fill` does not mind how they are turned)"
    )]
    NotSolid,
    /// Repairs leave no valid mesh.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// The grid is invalid.
    #[error(transparent)]
    Grid(#[from] GridError),
    /// The voxelmap is invalid.
    #[error(transparent)]
    Voxelmap(#[from] VoxelmapError),
    /// The tree is invalid.
    #[error(transparent)]
    Tree(#[from] TreeError),
}
