//! One job of the builder.

use std::sync::Arc;
use std::time::Instant;

use mesh_to_sdf::{SignMethod, Topology, generate_grid_sdf};
use serde::Serialize;
use vps_build::{BuildOptions, Density, Mesh};
use vps_core::{Asset, Grid};

use super::errors::{Reference, wrong_spheres};
use super::peak_memory::peak_memory;
use super::{
    ASSET, DENSE, MAP, MEMORY, MESHES, NARROW_GRID, PEER, SPARSE, SPHERES, Settings, WIDE_GRID,
};
use crate::experiments::experiment::Measurement;
use crate::experiments::shared::timed_build::timed_build;
use crate::experiments::shared::voxelmaps::VOXELMAPS;
use crate::harness::context::Context;
use crate::harness::job::Job;
use crate::harness::prepare::Preparation;

/// What a job measured; errors and bounds in units of a voxel.
#[derive(Clone, Debug, Default, Serialize)]
struct Row {
    triangles: Option<usize>,
    voxels_x: Option<u32>,
    voxels_y: Option<u32>,
    voxels_z: Option<u32>,
    points: Option<usize>,
    distances_s: Option<f64>,
    /// All stages from voxels to tree.
    build_s: Option<f64>,
    map_bytes: Option<usize>,
    tree_bytes: Option<usize>,
    file_bytes: Option<usize>,
    /// Step between two values that can be stored.
    quantization_voxels: Option<f64>,
    /// Within the band around the surface: the bound of the asset, and measured errors.
    near_bound_voxels: Option<f64>,
    near_error_voxels_mean: Option<f64>,
    near_error_voxels_max: Option<f64>,
    far_bound_voxels: Option<f64>,
    far_error_voxels_mean: Option<f64>,
    far_error_voxels_max: Option<f64>,
    spheres: Option<usize>,
    wrong_spheres: Option<usize>,
    peak_bytes: Option<f64>,
}

pub(super) fn run(
    settings: &Settings,
    job: &Job,
    context: &Context,
) -> Result<Measurement, String> {
    let subject = Subject {
        settings,
        context,
        mesh: &context.body(&settings.model, settings.scale)?.mesh,
    };
    let what = job.algorithm.as_str();
    let row = match job.case.as_str() {
        ASSET => subject.asset(what)?,
        MAP => subject.map(what)?,
        NARROW_GRID => subject.grid(what, settings.narrow_margin)?,
        WIDE_GRID => subject.grid(what, settings.margin)?,
        SPHERES => {
            let reference = subject.reference_map(settings.margin)?;
            Row {
                spheres: Some(settings.samples),
                wrong_spheres: Some(wrong_spheres(settings, subject.mesh, &reference.voxelmap)),
                ..Row::default()
            }
        }
        MEMORY => {
            let file = context.models.file(&settings.model);
            let file = file.map_err(|e| e.to_string())?;
            Row {
                peak_bytes: Some(peak_memory(settings, &file)?),
                ..Row::of(&*subject.reference_map(settings.margin)?)
            }
        }
        case => return Err(format!("no case `{case}`")),
    };
    Measurement::of(&[row], &Preparation::default())
}

struct Subject<'s> {
    settings: &'s Settings,
    context: &'s Context,
    mesh: &'s Mesh,
}

impl Subject<'_> {
    /// A whole asset.
    fn asset(&self, mesh: &str) -> Result<Row, String> {
        if mesh == MESHES[0] {
            return build(self.mesh, &self.settings.options());
        }
        let fine = self.context.once(&self.settings.model, || {
            let fine = |mesh: Mesh, _| mesh.subdivided();
            Ok((0..self.settings.subdivisions).fold(self.mesh.clone(), fine))
        })?;
        build(&fine, &self.settings.options())
    }

    /// A map in an encoding, with its errors.
    fn map(&self, name: &str) -> Result<Row, String> {
        let map = VOXELMAPS.iter().find(|(case, _)| *case == name);
        let (_, map) = map.ok_or_else(|| format!("no map `{name}`"))?;
        let margin = self.settings.margin;
        let options = map.options(self.settings.map_options(margin));
        self.map_with_errors(&options, margin)
    }

    /// A grid filled by a program, with the errors of its distances.
    fn grid(&self, program: &str, margin: u32) -> Result<Row, String> {
        let density = match program {
            SPARSE => Density::Sparse,
            DENSE => Density::Dense,
            PEER => return self.by_mesh_to_sdf(margin),
            other => return Err(format!("no program `{other}`")),
        };
        let options = BuildOptions {
            density,
            ..self.settings.map_options(margin)
        };
        self.map_with_errors(&options, margin)
    }

    fn map_with_errors(&self, options: &BuildOptions, margin: u32) -> Result<Row, String> {
        let (asset, times) = timed_build(self.mesh, options)?;
        let map = &asset.voxelmap;
        let given = |voxel| f64::from(map.center_penetration(voxel));
        Ok(Row {
            distances_s: Some(times.distances_s),
            build_s: Some(times.total_s()),
            ..Row::of(&asset)
        }
        .with_errors(&*self.reference(margin)?, map.grid(), given))
    }

    /// The same voxels by the other program.
    fn by_mesh_to_sdf(&self, margin: u32) -> Result<Row, String> {
        let map = &self.reference_map(margin)?.voxelmap;
        let vertices: Vec<[f32; 3]> = self
            .mesh
            .vertices()
            .iter()
            .map(|v| v.as_vec3().to_array())
            .collect();
        let indices: Vec<u32> = self.mesh.triangles().iter().flatten().copied().collect();
        let dims = map.grid().dims();
        let cells = dims.map(|n| n as usize);
        let first = map.grid().center([0; 3]).to_array();
        let grid = mesh_to_sdf::Grid::new(first, [map.grid().voxel_size(); 3], cells);
        let start = Instant::now();
        let distances = generate_grid_sdf(
            &vertices,
            Topology::TriangleList(Some(&indices)),
            &grid,
            SignMethod::Raycast,
        );
        let distances_s = start.elapsed().as_secs_f64();
        let [_, ny, nz] = cells;
        // z fastest, positive outside.
        let given = |[x, y, z]: [u32; 3]| {
            -f64::from(distances[(x as usize * ny + y as usize) * nz + z as usize])
        };
        let [voxels_x, voxels_y, voxels_z] = dims.map(Some);
        Ok(Row {
            voxels_x,
            voxels_y,
            voxels_z,
            distances_s: Some(distances_s),
            ..Row::default()
        }
        .with_errors(&*self.reference(margin)?, map.grid(), given))
    }

    /// The asset that tells which voxels are near the surface.
    fn reference_map(&self, margin: u32) -> Result<Arc<Asset<'static>>, String> {
        let options = self.settings.map_options(margin);
        let cached = self.context.assets.get(self.mesh, &options, &|_| ());
        cached.map(|c| c.asset).map_err(|e| e.to_string())
    }

    fn reference(&self, margin: u32) -> Result<Arc<Reference>, String> {
        let key = format!("{} {margin}", self.settings.model);
        self.context.once(&key, || {
            let asset = self.reference_map(margin)?;
            Reference::new(self.settings, self.mesh, &asset.voxelmap)
        })
    }
}

/// Builds an asset without a cache.
fn build(mesh: &Mesh, options: &BuildOptions) -> Result<Row, String> {
    let (asset, times) = timed_build(mesh, options)?;
    Ok(Row {
        triangles: Some(mesh.triangles().len()),
        distances_s: Some(times.distances_s),
        build_s: Some(times.total_s()),
        ..Row::of(&asset)
    })
}

impl Row {
    /// Sizes and bounds of an asset.
    fn of(asset: &Asset<'_>) -> Self {
        let map = &asset.voxelmap;
        let voxel = f64::from(map.grid().voxel_size());
        let [voxels_x, voxels_y, voxels_z] = map.grid().dims().map(Some);
        let bounds = map.error_bounds();
        Self {
            voxels_x,
            voxels_y,
            voxels_z,
            points: Some(asset.tree.point_count()),
            map_bytes: Some(map.store().byte_len()),
            tree_bytes: Some(asset.tree.byte_len()),
            file_bytes: Some(asset.to_bytes().len()),
            quantization_voxels: Some(f64::from(map.sigma()) / voxel),
            near_bound_voxels: Some(f64::from(bounds.in_band) / voxel),
            far_bound_voxels: Some(f64::from(bounds.beyond) / voxel),
            ..Self::default()
        }
    }

    /// Adds the errors of penetrations in metres, given by voxel.
    fn with_errors(
        self,
        reference: &Reference,
        grid: &Grid,
        given: impl Fn([u32; 3]) -> f64,
    ) -> Self {
        let voxel = f64::from(grid.voxel_size());
        let [near, far] = [&reference.near, &reference.far].map(|voxels| voxels.errors(&given));
        Self {
            near_error_voxels_mean: Some(near.mean_m / voxel),
            near_error_voxels_max: Some(near.max_m / voxel),
            far_error_voxels_mean: Some(far.mean_m / voxel),
            far_error_voxels_max: Some(far.max_m / voxel),
            ..self
        }
    }
}
