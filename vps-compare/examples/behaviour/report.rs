//! What scenes showed, in Markdown.

use std::fmt::Write;

use crate::models::{BUNNY_KINDS, BUNNY_PARTS, Kind, MADE_PARTS, SEGMENTS_LEVEL, VARIED};
use crate::record::Row;
use crate::scenes::{SCENES, Scene};
use crate::setup::{RECYCLINGS, Recycling, Setup};
use crate::{PATIENCE, PLAYED_ONCE, STARTS};

/// The whole report.
pub(crate) fn report(rows: &[Row]) -> String {
    let mut text = format!(
        "# Behaviour\n\n\
         Written by `just behaviour-report`. Every scene is a rapier world played with all kinds of\n\
         shapes: VPS, a convex decomposition (VHACD, at most {BUNNY_PARTS} parts of 100 vertices for\n\
         the bunny and {MADE_PARTS} for other models) and parry's triangle mesh. Bodies have 1 kg\n\
         and the mass properties of their solid, whatever they collide as; grounds are boxes. 60\n\
         steps a second unless said otherwise; one thread. rapier's own settings but for two: bodies\n\
         do not sleep, and contacts are recycled only until a pair moved by 2 mm (rapier: 50 mm, a\n\
         fifth of a bunny); what other settings make of it is in the table of contact recycling. The\n\
         bunny has 35 596 points, or 799 where it says coarse; models made by code have 10 000.\n\
         *Segments* is VPS with the deepest contact of each segment of level {SEGMENTS_LEVEL} of the shell's tree\n\
         and without contact clustering, in a few scenes.\n\n\
         *Deepest* is how far any point of a body has been in another, looked at every fifth step by\n\
         the shells and voxelmaps of both, whatever they collide as. Where bodies should be at rest,\n\
         *left* is how deep any is in another at the end, *drift* how far a centre got in the last\n\
         second, *speed* what no part was faster than in it, and *energy* the most of all bodies\n\
         together. Steps a second count stepping alone; slow ones are stopped after 12 s of it (30 s\n\
         for the bolt, 20 s for the stack of bunnies, 60 s for the pile), and those that have not made\n\
         a step after {} s. Measured on {},\n\
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
            let row = played(rows, scene, Setup::new(kind)).next();
            let _ = write!(text, " {} |", row.map_or(String::new(), Row::cell));
        }
        text += "\n";
    }
    text += &of_starts(rows);
    text += &of_recycling(rows);
    text += &of_kept(rows);
    for scene in &SCENES {
        let what = what_of(scene, rows);
        let (title, about) = (capitalised(scene.name), scene.about);
        let _ = write!(
            text,
            "\n## {title}\n\n{about}\n\n\
             | algorithm | steps/s | deepest, mm | left, mm | drift, mm | speed, mm/s | energy, mJ | {what} | as it should be |\n\
             |---|---|---|---|---|---|---|---|---|\n"
        );
        for &kind in scene.kinds {
            for row in played(rows, scene, Setup::new(kind)) {
                let _ = writeln!(text, "{}", row.markdown());
            }
        }
    }
    text
}

/// From how many starts each scene went as it should.
fn of_starts(rows: &[Row]) -> String {
    let mut text = format!(
        "\n## Other starts\n\n\
         What one start shows may be luck. From how many of {STARTS} more scenes go as they should, all\n\
         bodies set aside by up to 0.5 % of their size and turned by up to 0.3 degrees:\n\n\
         | | {} |\n|---|{}\n",
        VARIED.map(Kind::name).join(" | "),
        "---|".repeat(VARIED.len()),
    );
    for scene in SCENES.iter().filter(|s| s.name != PLAYED_ONCE) {
        let _ = write!(text, "| {} |", scene.name);
        for kind in VARIED {
            let starts = (1..=STARTS).map(|start| Setup {
                start,
                ..Setup::new(kind)
            });
            let all: Vec<_> = starts.flat_map(|s| played(rows, scene, s)).collect();
            let passed = all.iter().filter(|row| row.passed()).count();
            let cell = if all.is_empty() {
                String::new()
            } else {
                passed.to_string()
            };
            let _ = write!(text, " {cell} |");
        }
        text += "\n";
    }
    text
}

/// What the settings of contact recycling make of each scene.
fn of_recycling(rows: &[Row]) -> String {
    let mut text = String::from(
        "\n## Contact recycling\n\n\
         rapier does not ask again for the contacts of a pair that hardly moved since it did. How far\n\
         that is decides about speed and, for whatever fits closely, about everything:\n\n|",
    );
    for kind in VARIED {
        for recycling in RECYCLINGS {
            let _ = write!(text, " | {}, {}", kind.name(), recycling.name());
        }
    }
    let columns = VARIED.len() * RECYCLINGS.len();
    let _ = writeln!(text, " |\n|---|{}", "---|".repeat(columns));
    for scene in &SCENES {
        let _ = write!(text, "| {} |", scene.name);
        for kind in VARIED {
            for recycling in RECYCLINGS {
                let setup = Setup {
                    recycling,
                    ..Setup::new(kind)
                };
                let row = played(rows, scene, setup).next();
                let _ = write!(text, " {} |", row.map_or(String::new(), Row::cell));
            }
        }
        text += "\n";
    }
    text
}

/// How many contacts are known again, where all are asked for in every step.
fn of_kept(rows: &[Row]) -> String {
    let mut text = format!(
        "\n## Contacts kept\n\n\
         Those whose impulse was handed on from the step before, so that the solver began with it: of the\n\
         contacts that bore something in a step, of pairs that did in the step before, the share that\n\
         rapier did not take for new, clusters of contacts where it joins them, in %. It is a new one\n\
         that comes where another was, and one that bore nothing for a step; which one is the same the\n\
         dispatchers say themselves: parry by features and places, VPS by points of the shell, and of\n\
         those left over by the closest with much the same normal. Without contact recycling.\n\n\
         | | {} |\n|---|{}\n",
        VARIED.map(Kind::name).join(" | "),
        "---|".repeat(VARIED.len()),
    );
    for scene in &SCENES {
        let _ = write!(text, "| {} |", scene.name);
        for kind in VARIED {
            let setup = Setup {
                recycling: Recycling::Off,
                ..Setup::new(kind)
            };
            let row = played(rows, scene, setup).next();
            let cell = row.map_or(String::new(), Row::kept);
            let _ = write!(text, " {cell} |");
        }
        text += "\n";
    }
    text
}

/// The row of a scene, if it was played that way.
fn played<'r>(rows: &'r [Row], scene: &Scene, setup: Setup) -> impl Iterator<Item = &'r Row> {
    let name = scene.name;
    rows.iter()
        .filter(move |row| row.scene() == name && row.setup() == setup)
}

/// What the number of a scene is.
pub(crate) fn what_of(scene: &Scene, rows: &[Row]) -> &'static str {
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
