//! The voxel grid of a build: edge of a voxel, dimensions, and the memory they need.

use vps_core::Grid;

use crate::error::BuildError;
use crate::mesh::Mesh;
use crate::options::{BuildOptions, ClosestPoints, Encoding, Resolution};

/// Voxels along the longest side without thin walls.
const AUTO_VOXELS: u32 = 100;

/// Memory per voxel around the mesh, in bytes: class and winding number.
const BYTES_PER_CLASS: f64 = 5.0;

/// Memory per voxel of a dense map, in bytes: layer, penetrations and value.
const BYTES_PER_VOXEL: f64 = 2.0 + 4.0 + 4.0 + 2.0;

/// Memory per voxel of a sparse map during its build, in bytes, if the surface passes through a tenth
/// of all cells.
const BYTES_PER_SPARSE_VOXEL: f64 = 0.5;

/// Memory per point until it is in its tree, in bytes.
const BYTES_PER_POINT: f64 = 512.0;

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

/// The grid of a build with about `points` points.
///
/// # Errors
/// When an option is out of range, or the memory limit is exceeded.
pub(crate) fn grid(mesh: &Mesh, options: &BuildOptions, points: f64) -> Result<Grid, BuildError> {
    let (low, high) = mesh.bounds();
    let extents = high - low;
    let size = voxel_size(mesh, options)?;
    if options.margin == 0 {
        return Err(BuildError::Margin);
    }
    // A side of a whole number of voxels stays so despite rounding.
    let inner = (extents / size - 1e-6).ceil().max(glamx::DVec3::ONE);
    let dims = inner + 2.0 * f64::from(options.margin);
    let voxels = dims.element_product();
    let has_table = options.density.is_dense(voxels)
        || options.encoding == Encoding::Layers
        || options.closest_points == ClosestPoints::GradientDescent;
    let per_voxel = if has_table {
        BYTES_PER_VOXEL
    } else {
        BYTES_PER_SPARSE_VOXEL
    };
    let needed = voxels * per_voxel
        + (inner + 2.0).element_product() * BYTES_PER_CLASS
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
