//! The voxelmaps that are built of a mesh: every encoding and store, and the paper's gradient descent.

use vps_build::{BuildOptions, ClosestPoints, Density, Encoding, PointCount};

/// Cases of voxelmaps: encoding and density.
pub(crate) const VOXELMAPS: [(&str, Map); 8] = [
    (
        "distances_sparse",
        Map::new(Encoding::Distances(None), Density::Sparse),
    ),
    (
        "distances_dense",
        Map::new(Encoding::Distances(None), Density::Dense),
    ),
    ("floats_sparse", Map::new(Encoding::Floats, Density::Sparse)),
    ("floats_dense", Map::new(Encoding::Floats, Density::Dense)),
    ("layers_sparse", Map::new(Encoding::Layers, Density::Sparse)),
    ("layers_dense", Map::new(Encoding::Layers, Density::Dense)),
    ("descent_sparse", Map::by_descent(Density::Sparse)),
    ("descent_dense", Map::by_descent(Density::Dense)),
];

/// A voxelmap by its options.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Map {
    encoding: Encoding,
    density: Density,
    is_by_descent: bool,
}

impl Map {
    const fn new(encoding: Encoding, density: Density) -> Self {
        Self {
            encoding,
            density,
            is_by_descent: false,
        }
    }

    const fn by_descent(density: Density) -> Self {
        Self {
            is_by_descent: true,
            ..Self::new(Encoding::Distances(None), density)
        }
    }

    /// Whether every voxel has an exact distance to all triangles, which takes as long as
    /// everything else together.
    pub(crate) fn is_slow(&self) -> bool {
        self.density == Density::Dense && self.encoding != Encoding::Layers && !self.is_by_descent
    }

    /// Options of a build of this map alone, all others being those of `whole`.
    pub(crate) fn options(&self, whole: BuildOptions) -> BuildOptions {
        BuildOptions {
            encoding: self.encoding,
            density: self.density,
            closest_points: if self.is_by_descent {
                ClosestPoints::GradientDescent
            } else {
                ClosestPoints::Exact
            },
            points: PointCount::About(1),
            ..whole
        }
    }
}
