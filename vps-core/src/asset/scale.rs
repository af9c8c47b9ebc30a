//! Uniformly scaled copies of an asset.

use alloc::vec::Vec;

use super::Asset;
use super::mass::MassProperties;
use crate::aabb::Aabb;
use crate::map::{ErrorBounds, Grid, GridError, Voxelmap, VoxelmapError, VoxelmapParts};
use crate::shell::{Cluster, ClusterParts, PointSphereTree, TreeError, TreeParts};

/// Why an asset cannot be scaled.
///
/// ```
/// use vps_core::{Asset, ScaleError};
///
/// fn halved(asset: &Asset<'_>) -> Result<Asset<'static>, ScaleError> {
///     assert_eq!(asset.scaled(-0.5).unwrap_err(), ScaleError::Factor(-0.5));
///     asset.scaled(0.5)
/// }
/// ```
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ScaleError {
    /// The factor is not positive and finite.
    #[error("the scale must be positive and finite, not {0}")]
    Factor(f32),
    /// The voxel size would exceed the range of 32-bit numbers.
    #[error(transparent)]
    Grid(#[from] GridError),
    /// The values would.
    #[error(transparent)]
    Voxelmap(#[from] VoxelmapError),
    /// The points would.
    #[error(transparent)]
    Tree(#[from] TreeError),
}

impl Asset<'_> {
    /// The solid scaled uniformly about the origin of the mesh. Copies all data. A solid scaled
    /// along a single axis has other distances, and must be built from its mesh.
    ///
    /// # Errors
    /// When the factor is not positive, or leads out of the range of 32-bit numbers.
    pub fn scaled(&self, factor: f32) -> Result<Asset<'static>, ScaleError> {
        if !(factor > 0.0 && factor.is_finite()) {
            return Err(ScaleError::Factor(factor));
        }
        Ok(Asset {
            origin: self.origin.map(|c| c * f64::from(factor)),
            voxelmap: scaled_map(&self.voxelmap, factor)?,
            tree: scaled_tree(&self.tree, factor)?,
            mass: scaled_mass(&self.mass, factor),
        })
    }
}

fn scaled_map(map: &Voxelmap<'_>, factor: f32) -> Result<Voxelmap<'static>, ScaleError> {
    let grid = map.grid();
    let grid = Grid::new(
        grid.origin() * factor,
        grid.voxel_size() * factor,
        grid.dims(),
    )?;
    let solid = map.solid();
    let ErrorBounds {
        in_band,
        beyond,
        narrow_band,
    } = map.error_bounds();
    // Every coordinate is rounded once more.
    let rounding = f32::EPSILON * (solid.min.abs().max(solid.max.abs())).length();
    let error_bounds = ErrorBounds {
        in_band: (in_band + rounding) * factor,
        beyond: (beyond + rounding) * factor,
        narrow_band: narrow_band * factor,
    };
    let solid = Aabb {
        min: solid.min * factor,
        max: solid.max * factor,
    };
    Ok(Voxelmap::from_parts(VoxelmapParts {
        grid,
        sigma: map.sigma() * factor,
        solid,
        error_bounds,
        store: map.store().clone().into_owned(),
        curvature_bounds: map.curvature_bounds().to_vec().into(),
    })?)
}

fn scaled_tree(
    tree: &PointSphereTree<'_>,
    factor: f32,
) -> Result<PointSphereTree<'static>, ScaleError> {
    let times = |v: &[f32; 3]| v.map(|c| c * factor);
    // Rounding may move a point out of its ball and away from its paraboloid by this.
    let slack = 8.0 * f32::EPSILON * tree.origin_distance_bound();
    let cluster = |Cluster(c): &Cluster| {
        Cluster::from(ClusterParts {
            center: times(&c.center),
            radius: (c.radius + slack) * factor,
            half_thickness: (c.half_thickness + slack) * factor,
            apex: c.apex * factor,
            half_curvature: c.half_curvature / factor,
            area: c.area * factor * factor,
            ..*c
        })
    };
    let points: Vec<_> = tree.points().iter().map(times).collect();
    let areas: Vec<_> = tree.areas().iter().map(|a| a * factor * factor).collect();
    let clusters: Vec<_> = tree.clusters().iter().map(cluster).collect();
    Ok(PointSphereTree::from_parts(TreeParts {
        points: points.into(),
        normals: tree.normals().to_vec().into(),
        areas: areas.into(),
        clusters: clusters.into(),
        level_starts: tree.level_starts().to_vec().into(),
    })?)
}

fn scaled_mass(mass: &MassProperties, factor: f32) -> MassProperties {
    let volume = factor * factor * factor;
    MassProperties {
        volume: mass.volume * volume,
        center_of_mass: mass.center_of_mass.map(|c| c * factor),
        inertia: mass.inertia.map(|i| i * volume * factor * factor),
    }
}
