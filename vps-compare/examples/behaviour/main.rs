//! What bodies do in rapier worlds: numbers for VPS, triangle meshes and convex decompositions side
//! by side, written to `reports/behaviour`. `just behaviour-report`; with names of scenes as
//! arguments, these alone are played and nothing is written.

mod kept;
mod models;
mod record;
mod scenes;
mod stage;

use std::fmt::Write;
use std::path::Path;
use std::sync::mpsc::channel;
use std::time::Duration;

use models::{BUNNY_KINDS, BUNNY_PARTS, Kind, MADE_PARTS, SEGMENTS_LEVEL};
use record::{COLUMNS, Row};
use scenes::{ENDLESS, SCENES, Scene};
use vps_build::write_atomically;

/// How long an endless scene may take.
const PATIENCE: Duration = Duration::from_secs(30);

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let chosen: Vec<String> = std::env::args().skip(1).collect();
    let is_chosen = |scene: &&Scene| chosen.is_empty() || chosen.iter().any(|c| c == scene.name);
    let mut rows = Vec::new();
    // What may not end comes last: it goes on beside whatever is played after it.
    let is_endless = |scene: &Scene, kind| kind == Kind::Trimesh && ENDLESS.contains(&scene.name);
    for is_last in [false, true] {
        for scene in SCENES.iter().filter(is_chosen) {
            for &kind in scene.kinds {
                if is_endless(scene, kind) != is_last {
                    continue;
                }
                let row = match is_last {
                    false => (scene.play)(kind),
                    true => patiently(scene, kind, what_of(scene, &rows)),
                };
                println!("{}: {} {}", scene.name, row.markdown(), row.what());
                rows.push(row);
            }
        }
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

/// A scene on a thread of its own, which is left alone when it takes too long.
fn patiently(scene: &'static Scene, kind: Kind, what: &'static str) -> Row {
    let (done, wait) = channel();
    // Nobody may be waiting any more.
    std::thread::spawn(move || drop(done.send((scene.play)(kind))));
    wait.recv_timeout(PATIENCE)
        .unwrap_or_else(|_| Row::unfinished(scene.name, kind, what))
}

fn report(rows: &[Row]) -> String {
    let mut text = format!(
        "# Behaviour\n\n\
         Written by `just behaviour-report`. Every scene is a rapier world played with all kinds of\n\
         shapes: VPS, a convex decomposition (VHACD, at most {BUNNY_PARTS} parts of 100 vertices for\n\
         the bunny and {MADE_PARTS} for other models) and parry's triangle mesh. Bodies have 1 kg\n\
         and the mass properties of their solid, whatever they collide as; grounds are boxes. 60\n\
         steps a second unless said otherwise, rapier's own settings but for contact recycling and\n\
         sleep, which are off; one thread. The bunny has 35 596 points, or 799 where it says coarse;\n\
         models made by code have 10 000. *Segments* is VPS with the deepest contact of each segment of\n\
         level {SEGMENTS_LEVEL} of the shell's tree and without contact clustering, in a few scenes.\n\n\
         *Deepest* is how far any point of a body has been in another, looked at every fifth step by\n\
         the shells and voxelmaps of both, whatever they collide as. *Contacts kept* are those whose\n\
         impulse was handed on from the step before, so that the solver began with it: of the contacts\n\
         that bore something in a step, of pairs that did in the step before, the share that rapier did\n\
         not take for new, clusters of contacts where it joins them. It is a new one that comes where\n\
         another was, and one that bore nothing for a step; which one is the same the dispatchers say\n\
         themselves: parry by features and places, VPS by points of the shell (or segments), and of those\n\
         left over by the closest with much the same normal. Where bodies should be at rest,\n\
         *drift* is how far a centre got in the last second, *speed* what no part was faster than\n\
         in it, and *energy* the most of all bodies together. Steps a second count stepping alone;\n\
         slow ones are stopped after 12 s of it (30 s for the bolt, 20 s for the stack of bunnies, 60 s\n\
         for the pile), and those that have not made a step after {} s. Measured on {},\n\
         {:.0} % of the time waiting for a core that others had.\n\n\
         | | {} |\n|---|---|---|---|---|\n",
        PATIENCE.as_secs(),
        processor(),
        100.0 * waited(),
        BUNNY_KINDS.map(Kind::name).join(" | "),
    );
    for scene in &SCENES {
        let what = what_of(scene, rows);
        let _ = write!(text, "| {}: {what} |", scene.name);
        for kind in BUNNY_KINDS {
            let mut of_scene = rows.iter().filter(|r| r.scene() == scene.name);
            let row = of_scene.find(|r| r.algorithm() == kind.name());
            let _ = write!(text, " {} |", row.map_or(String::new(), Row::cell));
        }
        text += "\n";
    }
    for scene in &SCENES {
        let of_scene: Vec<_> = rows.iter().filter(|r| r.scene() == scene.name).collect();
        let what = what_of(scene, rows);
        let (title, about) = (capitalised(scene.name), scene.about);
        let _ = write!(
            text,
            "\n## {title}\n\n{about}\n\n\
             | algorithm | steps/s | deepest, mm | contacts kept, % | drift, mm | speed, mm/s | energy, mJ | {what} | as it should be |\n\
             |---|---|---|---|---|---|---|---|---|\n"
        );
        for row in of_scene {
            let _ = writeln!(text, "{}", row.markdown());
        }
    }
    text
}

/// What the number of a scene is.
fn what_of(scene: &Scene, rows: &[Row]) -> &'static str {
    let mut of_scene = rows.iter().filter(|r| r.scene() == scene.name);
    of_scene.next().map_or("", Row::what)
}

fn processor() -> String {
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = info
        .lines()
        .find_map(|line| line.strip_prefix("model name"));
    let name = name.map(|name| name.trim_start_matches(['\t', ' ', ':']));
    name.unwrap_or("an unknown processor").into()
}

/// How much of its time this thread could have run but had no core; NaN where nobody knows.
fn waited() -> f64 {
    let stat = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    let mut ns = stat.split(' ').map(|n| n.parse().unwrap_or(f64::NAN));
    let [ran, waited] = [(); 2].map(|()| ns.next().unwrap_or(f64::NAN));
    waited / (ran + waited)
}

fn capitalised(name: &str) -> String {
    let (first, rest) = name.split_at(1);
    first.to_uppercase() + rest
}
