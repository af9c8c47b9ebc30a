//! Summarizes the cycles of the haptic loop.

use polars::prelude::DataFrame;
use serde::Serialize;

use super::real_time::PERIOD;
use super::{IDLE, of_case};
use crate::data::dataframe::{self, Row, rows};
use crate::data::stats::Sample;
use crate::data::tables::Tables;
use crate::error::Error;

/// The cycles of a scene.
struct Run {
    scene: String,
    store: String,
    cycles: Vec<Cycle>,
}

struct Cycle {
    time_s: f64,
    force_n: [f64; 3],
    torque_n_m: f64,
    penetration_m: f64,
    contacts: f64,
    collision_us: f64,
    replayed_us: f64,
    wrench_us: f64,
    cycle_us: f64,
    late_us: f64,
}

#[derive(Serialize)]
struct Deadlines<'r> {
    scene: &'r str,
    store: &'r str,
    cycles: usize,
    /// Cycles that ended later than the next was due.
    missed: usize,
    end_us_max: Option<f64>,
    late_us_p999: Option<f64>,
    late_us_max: Option<f64>,
    cycle_us_max: Option<f64>,
    /// Cycles that took longer than a period.
    long: usize,
}

#[derive(Serialize)]
struct Collision<'r> {
    scene: &'r str,
    store: &'r str,
    collision_us_median: Option<f64>,
    collision_us_p999: Option<f64>,
    collision_us_max: Option<f64>,
    replayed_us_median: Option<f64>,
    replayed_us_p999: Option<f64>,
    replayed_us_max: Option<f64>,
    wrench_us_median: Option<f64>,
    contacts_max: f64,
}

/// The largest values of a span of time.
#[derive(Serialize)]
struct Felt<'r> {
    scene: &'r str,
    store: &'r str,
    time_s: f64,
    force_n_max: f64,
    /// Of the change of the force from one cycle to the next.
    jump_n_max: f64,
    torque_n_m_max: f64,
    penetration_mm_max: f64,
    contacts_max: f64,
    replayed_us_max: f64,
}

#[derive(Serialize)]
struct Stores<'r> {
    scene: &'r str,
    force_difference_n_max: f64,
}

/// Cycles of a row of `course`.
const COURSE: usize = 10;

/// `deadlines`, `collision`: a row for each scene and store. `felt`, `course`: the largest values of
/// each second, and of each 10 ms. `stores`: how forces with both stores differ.
pub(super) fn summarize(dataframe: &DataFrame) -> Result<Tables, Error> {
    let runs = runs(dataframe)?;
    let scenes: Vec<_> = runs.iter().filter(|run| run.scene != IDLE).collect();
    let spans = |cycles| scenes.iter().flat_map(move |run| run.felt(cycles));
    let stores = scenes.chunk_by(|a, b| a.scene == b.scene);
    let stores = stores.filter_map(|runs| match runs {
        [a, b] => Some(a.difference(b)),
        _ => None,
    });
    Ok(Tables::from([
        (
            "deadlines".to_owned(),
            dataframe::of(runs.iter().map(Run::deadlines))?,
        ),
        (
            "collision".to_owned(),
            dataframe::of(scenes.iter().map(|run| run.collision()))?,
        ),
        ("felt".to_owned(), dataframe::of(spans(1000))?),
        ("course".to_owned(), dataframe::of(spans(COURSE))?),
        ("stores".to_owned(), dataframe::of(stores)?),
    ]))
}

fn runs(dataframe: &DataFrame) -> Result<Vec<Run>, Error> {
    let mut runs: Vec<Run> = Vec::new();
    for row in rows(dataframe) {
        let (case, store) = (row.text("case"), row.text("algorithm"));
        let (scene, _) = of_case(&case).ok_or_else(|| format!("no case `{case}`"))?;
        if !runs
            .last()
            .is_some_and(|run| run.scene == scene && run.store == store)
        {
            runs.push(Run {
                scene: scene.into(),
                store,
                cycles: Vec::new(),
            });
        }
        if let Some(run) = runs.last_mut() {
            run.cycles.push(Cycle::of(&row));
        }
    }
    Ok(runs)
}

impl Cycle {
    fn of(row: &Row<'_>) -> Self {
        let number = |column: &str| row.number(column).unwrap_or(f64::NAN);
        Self {
            time_s: number("time_s"),
            force_n: ["force_x_n", "force_y_n", "force_z_n"].map(number),
            torque_n_m: norm(["torque_x_n_m", "torque_y_n_m", "torque_z_n_m"].map(number)),
            penetration_m: number("penetration_m"),
            contacts: number("contacts"),
            collision_us: 1e-3 * number("collision_ns"),
            replayed_us: 1e-3 * number("collision_replayed_ns"),
            wrench_us: 1e-3 * number("wrench_replayed_ns"),
            cycle_us: 1e-3 * number("cycle_ns"),
            late_us: 1e-3 * number("late_ns"),
        }
    }

    /// The time from when it was due to its end.
    fn end_us(&self) -> f64 {
        self.late_us + self.cycle_us
    }

    /// The distance of the forces of two cycles.
    fn force_difference(&self, other: &Self) -> f64 {
        norm([0, 1, 2].map(|i| self.force_n[i] - other.force_n[i]))
    }
}

fn norm(vector: [f64; 3]) -> f64 {
    vector.map(|v| v * v).iter().sum::<f64>().sqrt()
}

impl Run {
    fn sample(&self, of: impl Fn(&Cycle) -> f64) -> Sample {
        Sample::of(self.cycles.iter().map(of))
    }

    fn deadlines(&self) -> Deadlines<'_> {
        let period_us = 1e6 * PERIOD.as_secs_f64();
        let count = |is: &dyn Fn(&Cycle) -> bool| self.cycles.iter().filter(|c| is(c)).count();
        let late = self.sample(|c| c.late_us);
        Deadlines {
            scene: &self.scene,
            store: &self.store,
            cycles: self.cycles.len(),
            missed: count(&|c| c.end_us() > period_us),
            end_us_max: self.sample(Cycle::end_us).max(),
            late_us_p999: late.quantile(0.999),
            late_us_max: late.max(),
            cycle_us_max: self.sample(|c| c.cycle_us).max(),
            long: count(&|c| c.cycle_us > period_us),
        }
    }

    fn collision(&self) -> Collision<'_> {
        let live = self.sample(|c| c.collision_us);
        let replayed = self.sample(|c| c.replayed_us);
        Collision {
            scene: &self.scene,
            store: &self.store,
            collision_us_median: live.median(),
            collision_us_p999: live.quantile(0.999),
            collision_us_max: live.max(),
            replayed_us_median: replayed.median(),
            replayed_us_p999: replayed.quantile(0.999),
            replayed_us_max: replayed.max(),
            wrench_us_median: self.sample(|c| c.wrench_us).median(),
            contacts_max: largest(&self.cycles, |c| c.contacts),
        }
    }

    /// The largest values of each span of so many cycles.
    fn felt(&self, span: usize) -> impl Iterator<Item = Felt<'_>> {
        let starts = (0..self.cycles.len()).step_by(span);
        starts.map(move |start| {
            let end = (start + span).min(self.cycles.len());
            let cycles = &self.cycles[start..end];
            // With the cycle before.
            let pairs = self.cycles[start.saturating_sub(1)..end].windows(2);
            Felt {
                scene: &self.scene,
                store: &self.store,
                time_s: cycles[0].time_s,
                force_n_max: largest(cycles, |c| norm(c.force_n)),
                jump_n_max: pairs
                    .map(|pair| pair[1].force_difference(&pair[0]))
                    .fold(0.0, f64::max),
                torque_n_m_max: largest(cycles, |c| c.torque_n_m),
                penetration_mm_max: 1e3 * largest(cycles, |c| c.penetration_m),
                contacts_max: largest(cycles, |c| c.contacts),
                replayed_us_max: largest(cycles, |c| c.replayed_us),
            }
        })
    }

    fn difference(&self, other: &Self) -> Stores<'_> {
        let both = self.cycles.iter().zip(&other.cycles);
        Stores {
            scene: &self.scene,
            force_difference_n_max: both.map(|(a, b)| a.force_difference(b)).fold(0.0, f64::max),
        }
    }
}

fn largest(cycles: &[Cycle], of: impl Fn(&Cycle) -> f64) -> f64 {
    cycles.iter().map(of).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use polars::df;

    use super::*;

    /// Cycles of a scene; the last but one begins late, and so the last does too.
    fn frame() -> DataFrame {
        let zero = [0.0; 4];
        df!(
            "case" => ["peg_1s"; 4],
            "algorithm" => ["dense"; 4],
            "seed" => zero,
            "time_s" => [0.0, 0.001, 0.002, 0.003],
            "force_x_n" => [0.0, 3.0, 3.0, 0.0],
            "force_y_n" => [0.0, 4.0, 4.0, 0.0],
            "force_z_n" => zero,
            "torque_x_n_m" => zero,
            "torque_y_n_m" => zero,
            "torque_z_n_m" => zero,
            "penetration_m" => [0.0, 0.001, 0.002, 0.0],
            "contacts" => [0.0, 2.0, 7.0, 0.0],
            "collision_ns" => [1e3, 2e3, 3e3, 4e3],
            "collision_replayed_ns" => [1e3, 1e3, 2e3, 1e3],
            "wrench_replayed_ns" => [1e3; 4],
            "cycle_ns" => [1e4, 1e4, 1.1e6, 1e4],
            "late_ns" => [0.0, 0.0, 9.5e5, 9.95e5],
        )
        .unwrap()
    }

    #[test]
    fn cycles_that_end_too_late_are_missed() {
        let tables = summarize(&frame()).unwrap();
        let deadlines = rows(&tables["deadlines"]).next().unwrap();
        let number = |column: &str| deadlines.number(column).unwrap();
        assert_eq!(number("cycles"), 4.0);
        assert_eq!((number("missed"), number("long")), (2.0, 1.0));
        assert!((number("end_us_max") - 2050.0).abs() < 1e-9);
    }

    #[test]
    fn the_largest_force_and_its_largest_jump_are_found() {
        let tables = summarize(&frame()).unwrap();
        let felt = rows(&tables["felt"]).next().unwrap();
        let number = |column: &str| felt.number(column).unwrap();
        assert_eq!((number("force_n_max"), number("jump_n_max")), (5.0, 5.0));
        assert_eq!(
            (number("penetration_mm_max"), number("contacts_max")),
            (2.0, 7.0)
        );
        let collision = rows(&tables["collision"]).next().unwrap();
        assert_eq!(collision.number("collision_us_median"), Some(2.5));
        assert_eq!(collision.number("replayed_us_max"), Some(2.0));
    }
}
