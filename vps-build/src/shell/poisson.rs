//! Poisson-disk sampling of a surface (section 2.1.2): centres of surface voxels are projected onto
//! the triangles, and kept unless they are too close to a point kept before.

use std::ops::Range;

use glamx::DVec3;
use rayon::prelude::*;

use crate::mesh::Mesh;
use crate::mesh::triangle::{closest_point, normal};
use crate::spatial::lattice::for_each_overlapped_cell;
use crate::spatial::spatial_hash::SpatialHash;

/// Spacing of points in voxels of the sampling grid: √2, as the paper suggests.
const ALPHA: f64 = std::f64::consts::SQRT_2;

/// Points at least `spacing` metres apart, except across thin walls. The candidates come from a lattice
/// of voxels smaller than the spacing by [`ALPHA`].
pub(crate) fn poisson_sample(mesh: &Mesh, spacing: f64) -> PoissonDisk {
    let size = spacing / ALPHA;
    let origin = mesh.bounds().0;
    let mut disk = PoissonDisk::new(spacing, origin);
    // A few batches at a time, to bound the memory of candidates.
    for chunk in batches(mesh, size).chunks(BATCHES_AT_ONCE) {
        let candidates: Vec<Vec<_>> = chunk
            .par_iter()
            .map(|triangles| {
                let mut candidates = Vec::new();
                for t in triangles.clone() {
                    let triangle = mesh.corners(t);
                    let normal = normal(triangle);
                    let first = candidates.len();
                    for_each_overlapped_cell(triangle, origin, size, |[x, y, z], center| {
                        candidates.push(([z, y, x], closest_point(triangle, center), normal));
                    });
                    // Row by row, so that neighbours follow each other.
                    candidates[first..].sort_unstable_by_key(|candidate| candidate.0);
                }
                candidates
            })
            .collect();
        for (_, point, normal) in candidates.into_iter().flatten() {
            disk.try_insert(point, normal);
        }
    }
    disk
}

/// Batches whose candidates are computed in parallel before insertion.
const BATCHES_AT_ONCE: usize = 64;

/// Approximate number of cells that the triangles of a batch overlap.
const CELLS_PER_BATCH: f64 = (1 << 12) as f64;

/// Ranges of triangles of about the same work.
fn batches(mesh: &Mesh, size: f64) -> Vec<Range<usize>> {
    let mut batches = Vec::new();
    let (mut start, mut cells) = (0, 0.0);
    for t in 0..mesh.triangles().len() {
        let [a, b, c] = mesh.corners(t);
        let around = a.distance(b) + b.distance(c) + c.distance(a);
        cells += 1.0 + around / size + (b - a).cross(c - a).length() / (size * size);
        if cells >= CELLS_PER_BATCH {
            batches.push(start..t + 1);
            (start, cells) = (t + 1, 0.0);
        }
    }
    batches.push(start..mesh.triangles().len());
    batches
}

/// Cosine of two normals below which points lie on the two sides of a thin wall, and may be closer
/// than the spacing.
const OPPOSITE_COSINE: f64 = -0.5;

/// Points at least a spacing apart.
pub(crate) struct PoissonDisk {
    /// Least distance in metres.
    pub(super) spacing: f64,
    pub(crate) points: Vec<DVec3>,
    /// Outward normals of the triangles of the points.
    pub(super) normals: Vec<DVec3>,
    hash: SpatialHash,
}

impl PoissonDisk {
    fn new(spacing: f64, origin: DVec3) -> Self {
        Self {
            spacing,
            points: Vec::new(),
            normals: Vec::new(),
            hash: SpatialHash::new(spacing, origin),
        }
    }

    /// Inserts the point unless a neighbour is closer than the spacing.
    fn try_insert(&mut self, point: DVec3, normal: DVec3) {
        let closest = self.spacing * self.spacing;
        let is_taken = |other: usize| {
            self.points[other].distance_squared(point) < closest
                && self.normals[other].dot(normal) > OPPOSITE_COSINE
        };
        if self.hash.find_near(point, is_taken).is_none() {
            self.hash.insert(point);
            self.points.push(point);
            self.normals.push(normal);
        }
    }
}
