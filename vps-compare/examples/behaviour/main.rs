//! What bodies do in rapier worlds: numbers for VPS, triangle meshes and convex decompositions side
//! by side, written to `reports/behaviour`. `just behaviour-report`; with names of scenes as
//! arguments, these alone are played and nothing is written.

mod kept;
mod models;
mod record;
mod report;
mod scenes;
mod setup;
mod stage;

use std::path::Path;
use std::sync::mpsc::channel;
use std::time::Duration;

use models::{Kind, VARIED};
use record::{COLUMNS, Row};
use report::{report, what_of};
use scenes::{ENDLESS, SCENES, Scene};
use setup::{RECYCLINGS, Setup};
use vps_build::write_atomically;

/// How long an endless scene may take.
pub(crate) const PATIENCE: Duration = Duration::from_secs(30);

/// So many other starts a scene is played from, to see whether what it shows was luck.
pub(crate) const STARTS: u32 = 10;

/// A scene that takes too long for that.
pub(crate) const PLAYED_ONCE: &str = "pile";

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let chosen: Vec<String> = std::env::args().skip(1).collect();
    let is_chosen = |scene: &&Scene| chosen.is_empty() || chosen.iter().any(|c| c == scene.name);
    let mut rows = Vec::new();
    // What may not end comes last: it goes on beside whatever is played after it.
    let is_endless = |scene: &Scene, kind| kind == Kind::Trimesh && ENDLESS.contains(&scene.name);
    let mut endless = Vec::new();
    println!("{COLUMNS}");
    for scene in SCENES.iter().filter(is_chosen) {
        for setup in setups(scene) {
            if is_endless(scene, setup.kind) {
                endless.push((scene, setup));
                continue;
            }
            let row = (scene.play)(setup);
            println!("{}", row.csv());
            rows.push(row);
        }
    }
    for (scene, setup) in endless {
        let row = patiently(scene, setup, what_of(scene, &rows));
        println!("{}", row.csv());
        rows.push(row);
    }
    if chosen.is_empty() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../reports/behaviour");
        std::fs::create_dir_all(&folder)?;
        write_atomically(&folder.join("README.md"), report(&rows).as_bytes())?;
        let lines: Vec<_> = rows.iter().map(Row::csv).collect();
        let csv = format!("{COLUMNS}\n{}\n", lines.join("\n"));
        write_atomically(&folder.join("behaviour.csv"), csv.as_bytes())?;
    }
    Ok(())
}

/// All ways a scene is played: with each kind of shapes; and, but for triangle meshes and segments,
/// with other settings of contact recycling and from other starts.
fn setups(scene: &Scene) -> Vec<Setup> {
    let mut setups = Vec::new();
    for &kind in scene.kinds {
        let setup = Setup::new(kind);
        setups.push(setup);
        if !VARIED.contains(&kind) {
            continue;
        }
        for recycling in RECYCLINGS {
            if recycling != setup.recycling {
                setups.push(Setup { recycling, ..setup });
            }
        }
        if scene.name != PLAYED_ONCE {
            setups.extend((1..=STARTS).map(|start| Setup { start, ..setup }));
        }
    }
    setups
}

/// A scene on a thread of its own, which is left alone when it takes too long.
fn patiently(scene: &'static Scene, setup: Setup, what: &'static str) -> Row {
    let (done, wait) = channel();
    // Nobody may be waiting any more.
    std::thread::spawn(move || drop(done.send((scene.play)(setup))));
    wait.recv_timeout(PATIENCE)
        .unwrap_or_else(|_| Row::unfinished(scene.name, setup, what))
}
