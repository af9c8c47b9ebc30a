//! Options of a build.

/// Resolution of the voxelmap.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Resolution {
    /// Edge of a voxel in metres.
    VoxelSize(f64),
    /// Voxels along the longest side of the mesh.
    VoxelsAlongLongest(u32),
    /// As [`VoxelsAlongLongest(100)`](Self::VoxelsAlongLongest), or finer if walls are thinner than
    /// such a voxel, within a quarter of the memory limit (see [`ThinWalls`](crate::ThinWalls)).
    #[default]
    Auto,
}

/// Number of points of the pointshell (section 2.1.2).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PointCount {
    /// This many, to within 2 %.
    About(u32),
    /// As many as fit at this distance in metres from each other, except across thin walls. Every
    /// position on the surface is within 2.23 times this distance of a point.
    Spacing(f64),
}

/// Encoding of the values of the voxelmap (section 2.1.1).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// 16-bit layers, one voxel size apart.
    Layers,
    /// 16-bit distances in metres truncated to this many decimal places (eq. 1). By default as many
    /// as fit.
    Distances(Option<i32>),
    /// 32-bit floating-point distances in metres.
    Floats,
}

/// Search for the point of the mesh closest to a voxel (section 2.1.1).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ClosestPoints {
    /// Among all triangles.
    #[default]
    Exact,
    /// As in the paper: on the triangle closest to the surface voxel reached by gradient descent in
    /// the layered map.
    GradientDescent,
}

/// Clustering of points.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Clustering {
    /// Top-down bisection across the principal axis. All clusters of a level have about as many points.
    #[default]
    Bisect,
    /// Bottom-up as in the paper (section 2.1.2): the nearest K points make a leaf, the nearest K
    /// leaves a cluster, and so on.
    BottomUp {
        /// Seed of the random first point.
        seed: u64,
    },
}

/// Whether all voxels are stored. A sparse map takes a fraction of the memory. Queries near flat
/// surfaces take as long as on a dense map, those of a body deep inside several times as long.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Density {
    /// Up to [`DENSE_VOXELS`] voxels.
    #[default]
    Auto,
    /// All voxels.
    Dense,
    /// Only voxels that cannot be interpolated to within one voxel size.
    Sparse,
}

impl Density {
    /// Whether a map of this many voxels stores all of them.
    pub(crate) fn is_dense(self, voxels: f64) -> bool {
        match self {
            Self::Auto => voxels <= DENSE_VOXELS as f64,
            Self::Dense => true,
            Self::Sparse => false,
        }
    }
}

/// Most voxels of a map that is dense by default.
pub const DENSE_VOXELS: usize = 1 << 16;

/// Options of [`build`](crate::build).
#[derive(Clone, Debug, PartialEq)]
pub struct BuildOptions {
    /// Resolution of the voxelmap.
    pub resolution: Resolution,
    /// Outer layers of voxels around the box of the mesh, at least 1.
    pub margin: u32,
    /// Number of points of the pointshell.
    pub points: PointCount,
    /// Children of a cluster K, at least 2.
    pub branching: u32,
    /// Clustering of points.
    pub clustering: Clustering,
    /// Encoding of the values.
    pub encoding: Encoding,
    /// Search for closest points.
    pub closest_points: ClosestPoints,
    /// Whether all voxels are stored.
    pub density: Density,
    /// Which side of a triangle is the inside.
    pub sign: Sign,
    /// Memory limit for voxels and points during the build, in bytes.
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

/// Which side of a triangle is the inside, and the treatment of holes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sign {
    /// As [`Winding`](Self::Winding), or as [`Generalized`](Self::Generalized) if the filling of the
    /// holes would exceed half of the area of the mesh.
    #[default]
    Auto,
    /// Behind it, by winding numbers, after neighbours are oriented and holes closed. Cavities stay
    /// hollow if their walls face them.
    Winding,
    /// Where the generalised winding number exceeds 1/2. Holes and cracks stay open.
    Generalized,
    /// Not reached by a flood fill from outside through voxels without triangles. For meshes with
    /// randomly oriented faces. Cavities are filled; holes must be smaller than a voxel.
    Fill,
}
