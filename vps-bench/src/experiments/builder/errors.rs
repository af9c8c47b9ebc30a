//! Errors of stored distances, against every triangle.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use vps_build::Mesh;
use vps_core::{DistanceField, Vec3, Voxelmap};

use super::Settings;
use super::brute_force::exact_penetration;

/// Voxels of a grid and their exact penetrations in metres.
pub(super) struct Voxels(Vec<([u32; 3], f64)>);

/// Random voxels of a grid, near the surface and elsewhere.
pub(super) struct Reference {
    pub(super) near: Voxels,
    pub(super) far: Voxels,
}

/// Mean and largest error in metres.
#[derive(Clone, Copy, Debug)]
pub(super) struct Errors {
    pub(super) mean_m: f64,
    pub(super) max_m: f64,
}

impl Reference {
    /// # Errors
    /// When there are no voxels near the surface, or none elsewhere.
    pub(super) fn new(
        settings: &Settings,
        mesh: &Mesh,
        map: &Voxelmap<'_>,
    ) -> Result<Self, String> {
        let mut rng = ChaCha8Rng::seed_from_u64(settings.voxel_seed);
        let dims = map.grid().dims();
        let band = settings.band_voxels * map.grid().voxel_size();
        let (mut near, mut far) = (Vec::new(), Vec::new());
        let samples = settings.samples;
        // The rarer of the two may be a thousandth of all.
        for _ in 0..1000 * samples.max(100) {
            if near.len() >= samples && far.len() >= samples {
                break;
            }
            let voxel = dims.map(|n| rng.random_range(0..n));
            let is_near = map.center_penetration(voxel).abs() < band;
            let voxels = if is_near { &mut near } else { &mut far };
            if voxels.len() < samples {
                voxels.push(voxel);
            }
        }
        if near.len() < samples || far.len() < samples {
            return Err("too few voxels are within builder.band_voxels, or beyond".into());
        }
        let exact = |voxels: Vec<[u32; 3]>| {
            let exact = |voxel| {
                let center = map.grid().center(voxel).as_dvec3();
                (voxel, exact_penetration(mesh, center))
            };
            Voxels(voxels.into_par_iter().map(exact).collect())
        };
        Ok(Self {
            near: exact(near),
            far: exact(far),
        })
    }
}

impl Voxels {
    /// The errors of penetrations in metres, given by voxel.
    pub(super) fn errors(&self, given: impl Fn([u32; 3]) -> f64) -> Errors {
        let errors = || {
            self.0
                .iter()
                .map(|&(voxel, exact)| (given(voxel) - exact).abs())
        };
        Errors {
            mean_m: errors().sum::<f64>() / self.0.len() as f64,
            max_m: errors().fold(0.0, f64::max),
        }
    }
}

/// The number of random balls that reach the surface, but do not by the bound of the map: those at
/// sharp edges, which lie outside of the interpolated surface by up to the error bound of the field.
pub(super) fn wrong_spheres(settings: &Settings, mesh: &Mesh, map: &Voxelmap<'_>) -> usize {
    let mut rng = ChaCha8Rng::seed_from_u64(settings.sphere_seed);
    let bounds = map.grid().bounds();
    let field = map.trilinear();
    let center = |_| {
        let t = Vec3::from_array([0; 3].map(|_| rng.random_range(0.0..1.0)));
        bounds.min + bounds.extents() * t
    };
    let centers: Vec<Vec3> = (0..settings.samples).map(center).collect();
    let is_wrong = |&&center: &&Vec3| {
        let distance = -exact_penetration(mesh, center.as_dvec3()) as f32;
        // A ball that touches the surface, and must not be culled.
        field.penetration_bound(center, distance.max(0.0) * (1.0 + 1e-5)) < 0.0
    };
    centers.par_iter().filter(is_wrong).count()
}
