//! Errors of penetration, direction, force and torque on solids for which they are known.
//!
//! The two halves of an asset are measured separately: voxelmaps at points of known penetration,
//! and pointshells in an exact half-space.

mod field;
mod present;
mod pressure;
mod shape;
mod shell;
mod summary;

use polars::prelude::DataFrame;
use rand::{Rng, RngExt};
use rapier3d::glamx::{DQuat, DVec3};
use serde::{Deserialize, Serialize};
use vps_build::{Density, Encoding};
use vps_core::{DistanceField, Voxelmap, Wrench};

use self::shape::Shape;
use crate::config::validate::positive;
use crate::data::tables::Tables;
use crate::error::Error;
use crate::experiments::experiment::{Experiment, Measurement};
use crate::harness::context::Context;
use crate::harness::job::Job;
use crate::harness::prepare::Preparation;
use crate::report::document::Block;
use crate::report::page::Page;

/// Shapes, voxelmaps and pointshells that are measured.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Settings {
    shapes: Vec<Shape>,
    /// Methods to store and sample a voxelmap.
    methods: Vec<Method>,
    voxel_sizes_m: Vec<f64>,
    /// Points at which a voxelmap is sampled, and their largest distance from the surface.
    samples: u32,
    band_m: f64,
    /// Points of pointshells.
    points: Vec<u32>,
    /// Poses at which force and torque are compared, and the depth of a shell in the half-space.
    poses: u32,
    depth_m: f64,
    seed: u64,
}

/// Encoding and sampling of a voxelmap.
#[derive(Clone, Copy, Debug, Deserialize, Eq, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
enum Method {
    /// Eq. 4 on 32-bit distances.
    Local,
    /// Eq. 5 on 32-bit distances.
    Linear,
    /// Interpolated, on 32-bit distances.
    Trilinear,
    /// Interpolated, on distances truncated to 16 bits (eq. 1) in a sparse map: the default. All
    /// others are dense.
    #[serde(rename = "trilinear_16_bit")]
    Trilinear16Bit,
    /// Interpolated, on numbers of layers.
    Layers,
}

/// One comparison; columns that do not apply are empty.
#[derive(Clone, Debug, Default, Serialize)]
struct AccuracyRow {
    voxel_size_m: Option<f64>,
    points: Option<u32>,
    sample: u32,
    /// Reported minus exact penetration.
    error_m: Option<f64>,
    /// The error bound the field states.
    error_bound_m: Option<f64>,
    /// Angle between the reported and the exact direction.
    direction_deg: Option<f64>,
    /// Length of the difference of forces, relative to the exact force.
    force_error: Option<f64>,
    /// Length of the difference of torques, relative to the exact force times half the width.
    torque_error: Option<f64>,
}

impl Method {
    const ALL: [Self; 5] = [
        Self::Local,
        Self::Linear,
        Self::Trilinear,
        Self::Trilinear16Bit,
        Self::Layers,
    ];

    fn name(self) -> &'static str {
        match self {
            Self::Local => "local",
            Self::Linear => "linear",
            Self::Trilinear => "trilinear",
            Self::Trilinear16Bit => "trilinear_16_bit",
            Self::Layers => "layers",
        }
    }

    fn label(self) -> &'static str {
        match self {
            Self::Local => "eq. 4, local",
            Self::Linear => "eq. 5, linear",
            Self::Trilinear => "trilinear",
            Self::Trilinear16Bit => "trilinear, 16 bits, sparse",
            Self::Layers => "trilinear, layers",
        }
    }

    fn encoding(self) -> Encoding {
        match self {
            Self::Local | Self::Linear | Self::Trilinear => Encoding::Floats,
            Self::Trilinear16Bit => Encoding::Distances(None),
            Self::Layers => Encoding::Layers,
        }
    }

    fn density(self) -> Density {
        match self {
            Self::Trilinear16Bit => Density::Sparse,
            _ => Density::Dense,
        }
    }

    fn field<'m>(self, map: &'m Voxelmap<'m>) -> Box<dyn DistanceField + 'm> {
        match self {
            Self::Local => Box::new(map.local()),
            Self::Linear => Box::new(map.linear()),
            Self::Trilinear | Self::Trilinear16Bit | Self::Layers => Box::new(map.trilinear()),
        }
    }
}

/// The angle between two directions in degrees; `None` if one of them is zero.
fn angle_deg(a: DVec3, b: DVec3) -> Option<f64> {
    let (a, b) = (a.try_normalize()?, b.try_normalize()?);
    // More accurate than the cosine for small angles.
    Some(2.0 * (a - b).length().atan2((a + b).length()).to_degrees())
}

/// Errors of force and torque relative to the exact force; `None` if that is zero.
fn wrench_errors(wrench: &Wrench, exact: (DVec3, DVec3), half_width: f64) -> Option<(f64, f64)> {
    let size = exact.0.length();
    let force = wrench.force.as_dvec3().distance(exact.0) / size;
    let torque = wrench.torque.as_dvec3().distance(exact.1) / (size * half_width);
    (size > 0.0).then_some((force, torque))
}

/// A uniformly distributed rotation (Shoemake, 1992).
fn random_rotation(rng: &mut impl Rng) -> DQuat {
    let [u, v, w]: [f64; 3] = rng.random();
    let (v, w) = (v * std::f64::consts::TAU, w * std::f64::consts::TAU);
    let (a, b) = ((1.0 - u).sqrt(), u.sqrt());
    DQuat::from_xyzw(a * v.sin(), a * v.cos(), b * w.sin(), b * w.cos()).normalize()
}

const SHELL: &str = "shell";

impl Experiment for Settings {
    fn check(&self) -> Result<(), String> {
        for &size in &self.voxel_sizes_m {
            positive("accuracy.voxel_sizes_m", size)?;
        }
        for &points in &self.points {
            positive("accuracy.points", points.into())?;
        }
        positive("accuracy.samples", self.samples.into())?;
        positive("accuracy.band_m", self.band_m)?;
        positive("accuracy.poses", self.poses.into())?;
        positive("accuracy.depth_m", self.depth_m)
    }

    fn jobs(&self, quick: bool) -> Vec<Job> {
        let mut jobs = Vec::new();
        for shape in &self.shapes[..if quick { 1 } else { self.shapes.len() }] {
            let methods = self.methods.iter().map(|method| method.name());
            let measured = methods.chain([SHELL]);
            jobs.extend(measured.map(|what| Job::new(shape.name(), what, 0)));
        }
        jobs
    }

    fn planning_keys(&self) -> &'static [&'static str] {
        &["shapes", "methods"]
    }

    fn run(&self, job: &Job, context: &Context) -> Result<Measurement, String> {
        let shape = job.find_case(self.shapes.iter().copied(), |shape| shape.name())?;
        let method = Method::ALL.into_iter().find(|m| m.name() == job.algorithm);
        let rows = match method {
            Some(method) => self.fields(shape, method, context)?,
            None => self.shells(shape, context)?,
        };
        Measurement::of(&rows, &Preparation::default())
    }

    fn summarize(&self, rows: &DataFrame) -> Result<Tables, Error> {
        summary::summarize(self, rows)
    }

    fn present(&self, page: &Page<'_>) -> Result<Vec<Block>, Error> {
        present::present(self, page)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_are_exact_also_when_small() {
        let right = angle_deg(DVec3::X, 3.0 * DVec3::Y).unwrap();
        assert!((right - 90.0).abs() < 1e-9);
        let small = angle_deg(DVec3::X, DVec3::new(1.0, 1e-9, 0.0)).unwrap();
        assert!((small.to_radians() / 1e-9 - 1.0).abs() < 1e-6);
        assert!((angle_deg(DVec3::X, -DVec3::X).unwrap() - 180.0).abs() < 1e-9);
        assert_eq!(angle_deg(DVec3::X, DVec3::ZERO), None);
    }

    #[test]
    fn errors_of_a_wrench_are_parts_of_the_force() {
        let exact = (DVec3::new(0.0, 2.0, 0.0), DVec3::new(1.0, 0.0, 0.0));
        let wrench = Wrench {
            force: vps_core::Vec3::new(0.0, 2.5, 0.0),
            torque: vps_core::Vec3::new(1.0, 0.0, 0.4),
        };
        let (force, torque) = wrench_errors(&wrench, exact, 0.1).unwrap();
        assert!((force - 0.25).abs() < 1e-6 && (torque - 2.0).abs() < 1e-6);
        assert_eq!(
            wrench_errors(&wrench, (DVec3::ZERO, DVec3::ZERO), 0.1),
            None
        );
    }
}
