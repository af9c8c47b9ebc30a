//! Runs an experiment: prepares the algorithms, simulates every job, writes the records.

use std::cell::RefCell;
use std::path::Path;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use vps_build::{
    AssetCache, BuildOptions, CachedAsset, Mesh, PointCount, Resolution, mass_properties, read_mesh,
};
use vps_compare::oracle::PlaneOracle;
use vps_compare::{
    AssetSource, CollisionAlgorithm, ConvexDecomposition, ConvexHull, Ground, Prepared, Scene,
    Trimesh, Vps, VpsGround,
};
use vps_rapier::Sampling;

use crate::config::{self, Experiment, Method, SamplingName};
use crate::drop::Drop;
use crate::environment::Environment;
use crate::models::{Models, sha256};
use crate::records::{JobRow, PreparationRow, StepRow};

/// Everything a run leaves behind.
pub(crate) struct Records {
    pub(crate) environment: Environment,
    pub(crate) preparations: Vec<PreparationRow>,
    pub(crate) jobs: Vec<JobRow>,
    pub(crate) steps: Vec<StepRow>,
}

type Error = Box<dyn std::error::Error>;

/// Runs all jobs of an experiment, one after the other: they are timed. A job that fails gives a
/// row that says so.
pub(crate) fn run(
    experiment: &Experiment,
    quick: bool,
    models: &Models,
    assets: &AssetCache,
) -> Result<Records, Error> {
    let path = models.file(&experiment.body.model)?;
    let mesh = read_mesh(&path, None)?;
    let named = |e: &dyn std::fmt::Display| format!("{}: {e}", path.display());
    let mesh = mesh.scaled(experiment.body.scale).map_err(|e| named(&e))?;
    let mass = mass_properties(&mesh).map_err(|e| named(&e))?;
    let drop = Drop {
        experiment,
        mass,
        oracle: PlaneOracle::new(&mesh).map_err(|e| named(&e))?,
    };
    let environment = Environment::of_now(experiment, quick, sha256(&std::fs::read(&path)?));

    let progress = ProgressBar::new(0);
    progress.enable_steady_tick(Duration::from_millis(200));
    let mut preparations = Vec::new();
    let mut ready = Vec::new();
    for algorithm in &experiment.algorithm {
        progress.set_style(ProgressStyle::default_spinner());
        progress.set_message(format!("preparing {}", algorithm.label));
        let (row, prepared) = prepare(experiment, algorithm, &mesh, assets);
        preparations.push(row);
        ready.extend(prepared.map(|p| (algorithm, p)));
    }
    let orientations = if quick {
        experiment.quick.orientations
    } else {
        experiment.runs.orientations
    };
    progress.set_length(u64::from(orientations) * ready.len() as u64);
    let style = "{bar:30} {pos}/{len} simulations, {elapsed} of about {duration}  {msg}";
    progress.set_style(ProgressStyle::with_template(style)?);
    let (mut jobs, mut steps) = (Vec::new(), Vec::new());
    // Orientation by orientation, so that a slow minute of the machine meets all algorithms.
    for orientation in 0..orientations {
        for (algorithm, prepared) in &ready {
            progress.set_message(algorithm.label.clone());
            let start = Instant::now();
            let result = drop.simulate(&algorithm.name, prepared, orientation);
            let status = match result {
                Ok(rows) => {
                    steps.extend(rows);
                    "ok".into()
                }
                Err(why) => why,
            };
            jobs.push(JobRow {
                algorithm: algorithm.name.clone(),
                orientation,
                status,
                simulate_s: start.elapsed().as_secs_f64(),
            });
            progress.inc(1);
        }
    }
    progress.finish_and_clear();
    Ok(Records {
        environment,
        preparations,
        jobs,
        steps,
    })
}

fn prepare(
    experiment: &Experiment,
    algorithm: &config::Algorithm,
    mesh: &Mesh,
    assets: &AssetCache,
) -> (PreparationRow, Option<Prepared>) {
    let scene = Scene {
        body: mesh,
        ground: Ground::Cuboid(experiment.ground.extents_m),
    };
    let used: RefCell<Vec<CachedAsset>> = RefCell::default();
    let get = |mesh: &Mesh, options: &BuildOptions| {
        let kept = assets
            .get(mesh, options, &|_| ())
            .map_err(|e| e.to_string())?;
        let asset = kept.asset.clone();
        used.borrow_mut().push(kept);
        Ok(asset)
    };
    let start = Instant::now();
    let result = match &algorithm.method {
        Method::Vps(settings) => vps(settings, &get).prepare(&scene),
        Method::ConvexHull => ConvexHull.prepare(&scene),
        &Method::ConvexDecomposition {
            parts,
            vertices,
            resolution,
        } => ConvexDecomposition {
            parts,
            vertices,
            resolution,
        }
        .prepare(&scene),
        Method::Trimesh => Trimesh.prepare(&scene),
    };
    let prepare_s = start.elapsed().as_secs_f64();
    let status = match &result {
        Ok(_) => "ok".into(),
        Err(error) => error.to_string(),
    };
    let prepared = result.ok();
    let size = prepared.iter().flat_map(|p| &p.size);
    let used = used.into_inner();
    let row = PreparationRow {
        algorithm: algorithm.name.clone(),
        status,
        prepare_s,
        asset_build_s: used
            .iter()
            .filter_map(|kept| kept.build_s)
            .reduce(|a, b| a + b),
        size: joined(size.map(|(what, n)| format!("{n} {what}"))),
        assets: joined(used.iter().map(|kept| kept.key.clone())),
        asset_bytes: used.iter().map(|kept| kept.file_bytes).sum(),
    };
    (row, prepared)
}

fn joined(parts: impl Iterator<Item = String>) -> String {
    parts.collect::<Vec<_>>().join(", ")
}

fn vps<'a>(settings: &config::Vps, assets: &'a AssetSource<'a>) -> Vps<'a> {
    let ground = match settings.ground_voxel_size_m {
        Some(size) => VpsGround::Voxelmap(BuildOptions {
            resolution: Resolution::VoxelSize(size),
            margin: settings.ground_margin.unwrap_or(4),
            // It is never the shell.
            points: PointCount::About(100),
            ..BuildOptions::default()
        }),
        None => VpsGround::Cuboid,
    };
    Vps {
        body: BuildOptions {
            resolution: Resolution::VoxelSize(settings.voxel_size_m),
            margin: settings.margin,
            points: PointCount::About(settings.points),
            branching: settings.branching,
            ..BuildOptions::default()
        },
        ground,
        sampling: match settings.sampling {
            SamplingName::Trilinear => Sampling::Trilinear,
            SamplingName::Local => Sampling::Local,
        },
        assets,
    }
}

impl Records {
    /// What failed, one text each.
    pub(crate) fn failures(&self) -> Vec<String> {
        let preparations = self.preparations.iter().filter(|p| p.status != "ok");
        let preparations = preparations.map(|p| format!("{}: {}", p.algorithm, p.status));
        let jobs = self.jobs.iter().filter(|j| j.status != "ok");
        let jobs = jobs.map(|j| {
            format!(
                "{}, orientation {}: {}",
                j.algorithm, j.orientation, j.status
            )
        });
        preparations.chain(jobs).collect()
    }

    /// Writes all records into a folder.
    pub(crate) fn write(&self, folder: &Path) -> Result<(), Error> {
        crate::records::write(&folder.join("steps.csv"), &self.steps)?;
        crate::records::write(&folder.join("jobs.csv"), &self.jobs)?;
        crate::records::write(&folder.join("preparations.csv"), &self.preparations)?;
        let environment = serde_json::to_string_pretty(&self.environment)?;
        vps_build::write_atomically(&folder.join("environment.json"), environment.as_bytes())?;
        Ok(())
    }

    /// Reads what [`write`](Self::write) wrote.
    pub(crate) fn read(folder: &Path) -> Result<Self, Error> {
        let path = folder.join("environment.json");
        let environment = std::fs::read(&path)
            .map_err(|e| format!("{}: {e}: has the experiment been run?", path.display()))?;
        let environment = serde_json::from_slice(&environment)
            .map_err(|e| format!("{}: {e}: run the experiment again", path.display()))?;
        Ok(Self {
            environment,
            preparations: crate::records::read(&folder.join("preparations.csv"))?,
            jobs: crate::records::read(&folder.join("jobs.csv"))?,
            steps: crate::records::read(&folder.join("steps.csv"))?,
        })
    }
}
