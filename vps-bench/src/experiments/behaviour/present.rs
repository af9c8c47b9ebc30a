//! Presents the tables of scenes.

use polars::prelude::DataFrame;

use super::record::{COMPLETE, STEPS};
use super::{Collider, Scene, SceneSettings, Settings};
use crate::data::dataframe::{Row, rows};
use crate::data::number_format::{fixed, significant};
use crate::data::stats::Sample;
use crate::error::Error;
use crate::report::document::{Block, Table};
use crate::report::page::Page;

pub(super) fn present(settings: &Settings, page: &Page<'_>) -> Result<Vec<Block>, Error> {
    let presentation = Presentation {
        settings,
        scenes: page.table("scenes")?,
    };
    let starts = rows(page.table("starts")?);
    let waited = Sample::of(starts.filter_map(|row| row.number("waited_percent")));
    let mut blocks = vec![
        presentation.overview(),
        presentation.starts(),
        presentation.recycling(),
        presentation.warm_starting(),
    ];
    for (&scene, settings) in &settings.scenes {
        blocks.extend(presentation.scene(scene, settings));
    }
    blocks.push(Block::Text(format!(
        "While a scene was played its thread waited for a core that others had for {} % of the time \
         (median of all scenes), {} % at most.",
        fixed(waited.median(), 1),
        fixed(waited.max(), 1)
    )));
    Ok(blocks)
}

struct Presentation<'p> {
    settings: &'p Settings,
    scenes: &'p DataFrame,
}

impl<'p> Presentation<'p> {
    fn row(&self, scene: Scene, collider: Collider, recycling_mm: f64) -> Option<Row<'p>> {
        rows(self.scenes).find(|row| {
            row.text("scene") == scene.name()
                && row.text("algorithm") == collider.name()
                && row.number("recycling_mm") == Some(recycling_mm)
        })
    }

    /// A row for each scene, a column for each collider; a cell is empty if it was not played.
    fn by_collider(
        &self,
        caption: &str,
        colliders: &[Collider],
        label: impl Fn(Scene) -> String,
        cell: impl Fn(Scene, Collider) -> Option<String>,
    ) -> Block {
        let mut head = vec!["scene"];
        head.extend(colliders.iter().map(|c| c.label()));
        let mut table = Table::new(caption, &head);
        for &scene in self.settings.scenes.keys() {
            let cells = colliders
                .iter()
                .map(|&collider| cell(scene, collider).unwrap_or_default());
            let cells: Vec<_> = cells.collect();
            table.push([label(scene)].into_iter().chain(cells));
        }
        Block::Table(table)
    }

    fn overview(&self) -> Block {
        let with_subject = |scene: Scene| format!("{}: {}", scene.label(), scene.subject().label);
        self.by_collider(
            "All scenes: the value each is about, and whether it went as it should",
            &Collider::ALL,
            with_subject,
            |scene, collider| {
                let row = self.row(scene, collider, self.settings.recycling_mm)?;
                Some(value_and_verdict(&row))
            },
        )
    }

    fn starts(&self) -> Block {
        let caption = format!(
            "Scenes that went as they should, of {} other starts: all bodies displaced by up to 0.5 % \
             of their size and turned by up to 0.3 degrees",
            self.settings.starts
        );
        self.by_collider(
            &caption,
            &self.settings.varied,
            Scene::label,
            |scene, collider| {
                let row = self.row(scene, collider, self.settings.recycling_mm)?;
                let starts = row.number("starts").filter(|n| *n > 0.0)?;
                let passed = fixed(row.number("starts_passed"), 0);
                Some(format!("{passed} of {}", fixed(starts, 0)))
            },
        )
    }

    /// A column for each collider and each distance of contact recycling.
    fn recycling(&self) -> Block {
        let mut ways = Vec::new();
        let mut distances: Vec<_> = self.settings.recyclings_mm().collect();
        distances.sort_by(f64::total_cmp);
        for &collider in &self.settings.varied {
            ways.extend(distances.iter().map(|&mm| (collider, mm)));
        }
        let heads = ways.iter().map(|(collider, mm)| match *mm {
            0.0 => format!("{}, off", collider.label()),
            mm => format!("{}, {mm} mm", collider.label()),
        });
        let heads: Vec<_> = heads.collect();
        let mut head = vec!["scene"];
        head.extend(heads.iter().map(String::as_str));
        let mut table = Table::new(
            "Contact recycling, by the distance a pair moves before rapier asks for its contacts again",
            &head,
        );
        for &scene in self.settings.scenes.keys() {
            let cell = |&(collider, mm): &(Collider, f64)| {
                let row = self.row(scene, collider, mm);
                row.map_or_else(String::new, |row| value_and_verdict(&row))
            };
            let cells: Vec<_> = ways.iter().map(cell).collect();
            table.push([scene.label()].into_iter().chain(cells));
        }
        Block::Table(table)
    }

    fn warm_starting(&self) -> Block {
        self.by_collider(
            "Contacts warm started with the impulse of the step before, %, without contact recycling: \
             of contacts with an impulse, of pairs that had one in the step before",
            &self.settings.varied,
            Scene::label,
            |scene, collider| {
                let row = self.row(scene, collider, 0.0)?;
                Some(fixed(row.number("warm_started_percent"), 1))
            },
        )
    }

    /// The text of a scene and a table of its colliders.
    fn scene(&self, scene: Scene, settings: &SceneSettings) -> [Block; 2] {
        let mut table = Table::new(
            capitalised(&scene.label()),
            &[
                "collides as",
                "steps/s",
                "deepest, mm",
                "deepest at the end, mm",
                "drift, mm",
                "speed, mm/s",
                "energy, mJ",
                scene.subject().label,
                "as it should be",
            ],
        );
        for &collider in &settings.colliders {
            let Some(row) = self.row(scene, collider, self.settings.recycling_mm) else {
                continue;
            };
            let number = |column: &str| {
                let value = row.number(column);
                value.map_or_else(String::new, significant)
            };
            table.push([
                collider.label().into(),
                number("steps_per_s"),
                number("deepest_mm"),
                number("deepest_at_end_mm"),
                number("drift_mm"),
                number("speed_mm_s"),
                number("energy_mj"),
                number("value"),
                verdict(&row),
            ]);
        }
        [Block::Text(settings.about.clone()), Block::Table(table)]
    }
}

fn value_and_verdict(row: &Row<'_>) -> String {
    match row.number("value") {
        Some(value) => format!("{}: {}", significant(value), verdict(row)),
        None => verdict(row),
    }
}

/// Whether a scene went as it should, or when it was stopped.
fn verdict(row: &Row<'_>) -> String {
    let is_one = |column: &str| row.number(column) == Some(1.0);
    match row.number(STEPS) {
        _ if is_one("passed") => "yes".into(),
        _ if is_one(COMPLETE) => "no".into(),
        Some(1.0) => "stopped after 1 step".into(),
        Some(steps) if steps > 0.0 => format!("stopped after {steps} steps"),
        _ => "not a step".into(),
    }
}

fn capitalised(name: &str) -> String {
    let (first, rest) = name.split_at(1);
    first.to_uppercase() + rest
}
