//! Summarizes scenes: which went as they should.

use std::collections::BTreeMap;

use polars::prelude::{Column, DataFrame};

use super::record::COMPLETE;
use super::{Scene, SceneSettings, Settings};
use crate::data::dataframe::rows;
use crate::data::tables::Tables;
use crate::error::Error;

/// A job: a scene as it was played.
struct Played {
    scene: Scene,
    recycling_mm: f64,
    collider: String,
    start: f64,
    /// `None` for those that could not be measured.
    quantities: BTreeMap<String, Option<f64>>,
}

/// `scenes`: a row for each scene, contact recycling and collider, with the quantities of the first
/// start, the scene's subject as `value`, whether it went as it should as `passed`, 1 or 0, and the
/// number of other starts that did. `starts`: a row for each job.
pub(super) fn summarize(settings: &Settings, rows: &DataFrame) -> Result<Tables, Error> {
    let all = played(settings, rows)?;
    check_limits(settings, &all)?;
    let firsts: Vec<_> = all.iter().filter(|p| p.start == 0.0).collect();
    let others = |first: &Played| {
        let is_other = |p: &&Played| {
            (p.scene, &p.collider, p.recycling_mm)
                == (first.scene, &first.collider, first.recycling_mm)
                && p.start > 0.0
        };
        let others = all.iter().filter(is_other);
        let passed = others.clone().filter(|p| p.passed(settings));
        (others.count() as f64, passed.count() as f64)
    };
    let counts: Vec<_> = firsts.iter().map(|first| others(first)).collect();
    let mut scenes = columns(settings, &firsts);
    scenes.push(Column::new(
        "starts".into(),
        counts.iter().map(|c| c.0).collect::<Vec<_>>(),
    ));
    scenes.push(Column::new(
        "starts_passed".into(),
        counts.iter().map(|c| c.1).collect::<Vec<_>>(),
    ));
    let starts = columns(settings, &all.iter().collect::<Vec<_>>());
    Ok(Tables::from([
        ("scenes".to_owned(), DataFrame::new(firsts.len(), scenes)?),
        ("starts".to_owned(), DataFrame::new(all.len(), starts)?),
    ]))
}

/// The rows of each job together.
fn played(settings: &Settings, dataframe: &DataFrame) -> Result<Vec<Played>, Error> {
    let mut all: Vec<Played> = Vec::new();
    for row in rows(dataframe) {
        let case = row.text("case");
        let mut cases = settings.cases();
        let of_case = cases.find(|&(scene, mm)| Settings::case(scene, mm) == case);
        let (scene, recycling_mm) = of_case.ok_or_else(|| format!("no case `{case}`"))?;
        let collider = row.text("algorithm");
        let start = row.number("seed").unwrap_or_default();
        let is_same = |p: &Played| {
            (p.scene, p.recycling_mm, p.start) == (scene, recycling_mm, start)
                && p.collider == collider
        };
        if !all.last().is_some_and(is_same) {
            all.push(Played {
                scene,
                recycling_mm,
                collider,
                start,
                quantities: BTreeMap::new(),
            });
        }
        if let Some(last) = all.last_mut() {
            last.quantities
                .insert(row.text("quantity"), row.number("value"));
        }
    }
    Ok(all)
}

/// Checks that limits are of quantities that were measured.
fn check_limits(settings: &Settings, all: &[Played]) -> Result<(), String> {
    for (scene, SceneSettings { limits, .. }) in &settings.scenes {
        let of_scene: Vec<_> = all.iter().filter(|p| p.scene == *scene).collect();
        for quantity in limits.keys() {
            if !of_scene.is_empty() && !of_scene.iter().any(|p| p.quantities.contains_key(quantity))
            {
                let key = format!("behaviour.scenes.{}.limits", scene.name());
                return Err(format!("{key}: no run has a quantity `{quantity}`"));
            }
        }
    }
    Ok(())
}

impl Played {
    fn quantity(&self, name: &str) -> Option<f64> {
        *self.quantities.get(name)?
    }

    /// Whether it was played to its end, within all limits of its scene.
    fn passed(&self, settings: &Settings) -> bool {
        let limits = settings.scenes.get(&self.scene).map(|s| &s.limits);
        let mut limits = limits.into_iter().flatten();
        self.quantity(COMPLETE) == Some(1.0)
            && limits.all(|(name, limit)| self.quantity(name).is_some_and(|v| limit.holds(v)))
    }
}

/// The columns of scenes that were played.
fn columns(settings: &Settings, played: &[&Played]) -> Vec<Column> {
    let texts = |of: &dyn Fn(&Played) -> String| played.iter().map(|p| of(p)).collect::<Vec<_>>();
    let numbers =
        |of: &dyn Fn(&Played) -> Option<f64>| played.iter().map(|p| of(p)).collect::<Vec<_>>();
    let mut columns = vec![
        Column::new("scene".into(), texts(&|p| p.scene.name().into())),
        Column::new("algorithm".into(), texts(&|p| p.collider.clone())),
        Column::new("recycling_mm".into(), numbers(&|p| Some(p.recycling_mm))),
        Column::new("start".into(), numbers(&|p| Some(p.start))),
        Column::new(
            "value".into(),
            numbers(&|p| p.quantity(p.scene.subject().quantity)),
        ),
        Column::new(
            "passed".into(),
            numbers(&|p| Some(f64::from(u8::from(p.passed(settings))))),
        ),
    ];
    let mut names: Vec<&String> = played.iter().flat_map(|p| p.quantities.keys()).collect();
    names.sort();
    names.dedup();
    for name in names {
        columns.push(Column::new(
            name.as_str().into(),
            numbers(&|p| p.quantity(name)),
        ));
    }
    columns
}

#[cfg(test)]
mod tests {
    use polars::df;

    use super::*;

    fn settings() -> Settings {
        toml::from_str(
            r#"
            segments_level = 3
            recycling_mm = 2.0
            other_recycling_mm = [0.0]
            starts = 2
            varied = ["vps"]
            [models]
            bunny = "bunny"
            bunny_scale = 1.0
            bunny_voxel_size_m = 0.1
            bunny_points = 10
            bunny_coarse_points = 5
            bunny_parts = 2
            parts = 2
            part_vertices = 50
            decomposition_resolution = 10
            [scenes.rest]
            about = "It rests."
            colliders = ["vps"]
            limits = { speed_mm_s = { at_most = 1.0 } }
            "#,
        )
        .unwrap()
    }

    /// Quantities of a start.
    fn frame(quantities: &[(f64, &str, Option<f64>)]) -> DataFrame {
        df!(
            "case" => vec!["rest_2mm"; quantities.len()],
            "algorithm" => vec!["vps"; quantities.len()],
            "seed" => quantities.iter().map(|q| q.0).collect::<Vec<_>>(),
            "quantity" => quantities.iter().map(|q| q.1).collect::<Vec<_>>(),
            "value" => quantities.iter().map(|q| q.2).collect::<Vec<_>>(),
        )
        .unwrap()
    }

    #[test]
    fn a_scene_passes_if_it_is_complete_and_within_its_limits() {
        let all = frame(&[
            (0.0, "complete", Some(1.0)),
            (0.0, "speed_mm_s", Some(0.5)),
            (1.0, "complete", Some(1.0)),
            (1.0, "speed_mm_s", Some(2.0)),
            (2.0, "complete", Some(0.0)),
            (2.0, "speed_mm_s", Some(0.5)),
            (3.0, "complete", Some(1.0)),
            (3.0, "speed_mm_s", None),
            (4.0, "complete", Some(1.0)),
            (4.0, "speed_mm_s", Some(1.0)),
        ]);
        let tables = summarize(&settings(), &all).unwrap();
        let passed: Vec<_> = rows(&tables["starts"])
            .map(|row| row.number("passed").unwrap())
            .collect();
        assert_eq!(passed, [1.0, 0.0, 0.0, 0.0, 1.0]);
        let first = rows(&tables["scenes"]).next().unwrap();
        let number = |column: &str| first.number(column).unwrap();
        assert_eq!(number("value"), 0.5);
        assert_eq!((number("starts"), number("starts_passed")), (4.0, 1.0));
    }

    #[test]
    fn a_limit_of_an_unknown_quantity_is_an_error() {
        let all = frame(&[(0.0, "complete", Some(1.0)), (0.0, "speed_m_s", Some(0.5))]);
        let error = summarize(&settings(), &all).unwrap_err().to_string();
        assert!(error.contains("behaviour.scenes.rest.limits"), "{error}");
    }
}
