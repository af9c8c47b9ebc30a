//! The voxelmap of a solid: stored values, error bounds and curvature (section 2.1.1).

use vps_core::raw::{Store, VoxelmapParts};
use vps_core::{Aabb, ErrorBounds, Grid, Voxelmap};

use super::curvature::curvature_bounds;
use super::distance::{ExactDistances, by_gradient_descent};
use super::lattice::Source;
use super::layers::layers;
use super::quantize::Quantizer;
use super::sparse::{Tolerance, sparse};
use crate::error::BuildError;
use crate::options::{BuildOptions, ClosestPoints, Encoding};
use crate::solid::Solid;
use crate::spatial::bvh::Bvh;

/// Half-width of the narrow band in voxels: there every voxel is stored.
const NARROW_BAND: f64 = 4.0;

/// Samples the solid on a grid.
///
/// # Errors
/// When the distances do not fit the encoding, or the parts do not make a voxelmap.
pub(crate) fn voxelmap(
    solid: &Solid<'_>,
    bvh: &Bvh,
    grid: Grid,
    options: &BuildOptions,
) -> Result<Voxelmap<'static>, BuildError> {
    let Solid { mesh, classes, .. } = solid;
    let (low, high) = mesh.bounds();
    let bounds = grid.bounds();
    // Rounding may put the mesh slightly outside of the grid.
    let solid = Aabb {
        min: bounds.clamp(low.as_vec3()),
        max: bounds.clamp(high.as_vec3()),
    };
    let size = f64::from(grid.voxel_size());
    let is_dense = options.density.is_dense(grid.voxel_count() as f64);
    let exact;
    let table;
    let source = match (options.encoding, options.closest_points) {
        (Encoding::Layers, _) => {
            table = layers(&grid, classes)
                .iter()
                .map(|&layer| f32::from(layer) * grid.voxel_size())
                .collect::<Vec<_>>();
            Source::Table(&table)
        }
        (_, ClosestPoints::GradientDescent) => {
            table = by_gradient_descent(mesh, bvh, &grid, classes);
            Source::Table(&table)
        }
        (_, ClosestPoints::Exact) => {
            exact = ExactDistances::new(bvh, &grid, classes);
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
    let quantizer = match options.encoding {
        Encoding::Layers => Quantizer::Layers(size),
        Encoding::Distances(precision) => {
            Quantizer::Integers(quantization_step(precision, largest)?)
        }
        Encoding::Floats => Quantizer::Floats,
    };
    // One truncated step, and the rounding of 32-bit coordinates.
    let largest_coordinate = bounds.min.abs().max(bounds.max.abs()).length();
    let rounding = 8.0 * f64::from(f32::EPSILON * largest_coordinate);
    let stored = match quantizer {
        Quantizer::Integers(step) | Quantizer::Layers(step) => step + rounding,
        Quantizer::Floats => rounding,
    };
    let interpolated = if is_dense {
        0.0
    } else {
        size.max(2.0 * stored)
    };
    let store = match source {
        Source::Table(table) if is_dense => {
            Store::dense(grid.dims(), quantizer.quantize_all(table))?
        }
        _ => {
            let tolerance = Tolerance {
                beyond_band: interpolated - rounding,
                narrow_band: NARROW_BAND * size,
                in_band: match options.encoding {
                    Encoding::Layers => 1e-6 * size,
                    Encoding::Distances(_) => quantizer.sigma(),
                    Encoding::Floats => 0.25 * rounding,
                },
            };
            sparse(&grid, &source, &lattice, quantizer, tolerance)?
        }
    };
    let is_exact = matches!(options.closest_points, ClosestPoints::Exact);
    let (in_band, beyond) = if is_exact && options.encoding != Encoding::Layers {
        (stored, interpolated.max(stored))
    } else {
        // The centre of layer n is between (n - 1/2) s and √3 (n + 1/2) s from the surface.
        let error = |layers: f64| (1.7321 * (layers + 0.5) - layers) * size + stored;
        (
            error(NARROW_BAND),
            error((largest / size).max(NARROW_BAND)) + interpolated,
        )
    };
    let error_bounds = ErrorBounds {
        in_band: in_band as f32,
        beyond: beyond as f32,
        narrow_band: ((NARROW_BAND - 0.01) * size) as f32,
    };
    let curvature = curvature_bounds(&store, (quantizer.sigma() / size) as f32);
    Ok(Voxelmap::from_parts(VoxelmapParts {
        grid,
        sigma: quantizer.sigma() as f32,
        solid,
        error_bounds,
        store,
        curvature_bounds: curvature.into(),
    })?)
}

/// The quantisation step of eq. 1: λ = 10^-p. By default p is the most decimal places for which
/// distances up to `largest` fit 16 bits.
fn quantization_step(precision: Option<i32>, largest: f64) -> Result<f64, BuildError> {
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
