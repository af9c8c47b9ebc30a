//! A haptic loop of 1 kHz in real time: its deadlines, the time of its collision part, and the forces a
//! scripted device exerts.

mod device;
mod measure;
mod meshes;
mod present;
mod real_time;
mod scenes;
mod summary;

use polars::prelude::DataFrame;
use serde::{Deserialize, Serialize};

use crate::config::validate::positive;
use crate::data::tables::Tables;
use crate::error::Error;
use crate::experiments::experiment::{Experiment, Measurement};
use crate::harness::context::Context;
use crate::harness::job::Job;
use crate::harness::prepare::Preparation;
use crate::report::document::Block;
use crate::report::page::Page;
use scenes::{STORES, Scene, SceneName, SceneSettings};

/// The scenes and the loop.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Settings {
    /// The solid the stylus probes: a name in `models.toml` or the path of a mesh.
    model: String,
    /// Length of a unit of the model in metres.
    scale: f64,
    /// Time each scene is run.
    seconds: u32,
    quick_seconds: u32,
    /// Repetitions of each query afterwards; the shortest time counts.
    replays: u32,
    /// Stiffness of the virtual coupling.
    stiffness_n_m: f32,
    angular_stiffness_n_m_per_rad: f32,
    stylus: SceneSettings,
    peg: SceneSettings,
}

/// The loop without anything to do, which tells the deadlines the machine misses by itself.
const IDLE: &str = "nothing";

impl Settings {
    fn scene(&self, name: SceneName) -> &SceneSettings {
        match name {
            SceneName::Stylus => &self.stylus,
            SceneName::Peg => &self.peg,
        }
    }

    /// A case says how long it runs: a quick run is another one.
    fn case(scene: &str, seconds: u32) -> String {
        format!("{scene}_{seconds}s")
    }
}

/// The scene of a case and its time in seconds.
fn of_case(case: &str) -> Option<(&str, u32)> {
    let (scene, seconds) = case.strip_suffix('s')?.rsplit_once('_')?;
    Some((scene, seconds.parse().ok()?))
}

impl Experiment for Settings {
    fn check(&self) -> Result<(), String> {
        positive("haptics.scale", self.scale)?;
        positive("haptics.replays", self.replays.into())?;
        positive("haptics.stiffness_n_m", self.stiffness_n_m.into())?;
        positive(
            "haptics.angular_stiffness_n_m_per_rad",
            self.angular_stiffness_n_m_per_rad.into(),
        )?;
        for seconds in [self.seconds, self.quick_seconds] {
            positive("haptics.seconds", seconds.into())?;
        }
        for scene in SceneName::ALL {
            let settings = self.scene(scene);
            let key = |key: &str| format!("haptics.{}.{key}", scene.name());
            positive(&key("mass_kg"), settings.mass_kg.into())?;
            positive(&key("voxel_size_m"), settings.voxel_size_m)?;
            let stiffness = settings.contact_stiffness_n_m3;
            positive(&key("contact_stiffness_n_m3"), stiffness.into())?;
        }
        Ok(())
    }

    fn jobs(&self, quick: bool) -> Vec<Job> {
        let seconds = if quick {
            self.quick_seconds
        } else {
            self.seconds
        };
        let job = |scene: &str, store: &str| Job::new(Self::case(scene, seconds), store, 0);
        let mut jobs = vec![job(IDLE, "none")];
        for scene in SceneName::ALL {
            jobs.extend(STORES.map(|(store, _)| job(scene.name(), store)));
        }
        jobs
    }

    fn planning_keys(&self) -> &'static [&'static str] {
        &["seconds", "quick_seconds"]
    }

    fn identity(&self, context: &Context) -> Result<String, String> {
        Ok(context.body(&self.model, self.scale)?.identity.clone())
    }

    fn run(&self, job: &Job, context: &Context) -> Result<Measurement, String> {
        let no_case = || format!("no case `{}` of `{}`", job.case, job.algorithm);
        let (name, seconds) = of_case(&job.case).ok_or_else(no_case)?;
        let cycles = 1000 * seconds as usize;
        let rows = if name == IDLE {
            measure::idle(cycles)
        } else {
            let name = SceneName::ALL.into_iter().find(|s| s.name() == name);
            let store = STORES
                .into_iter()
                .find(|(store, _)| *store == job.algorithm);
            let ((_, density), name) = store.zip(name).ok_or_else(no_case)?;
            Scene::new(self, name, density, context)?.measure(cycles, self.replays)?
        };
        Measurement::of(&rows, &Preparation::default())
    }

    fn summarize(&self, rows: &DataFrame) -> Result<Tables, Error> {
        summary::summarize(rows)
    }

    fn present(&self, page: &Page<'_>) -> Result<Vec<Block>, Error> {
        present::present(page)
    }
}
