//! What a scene showed, as a row of tables.

use std::fmt::Write;

use crate::setup::Setup;
use crate::stage::{Rest, Stage};

/// One kind of shape in one scene.
pub(crate) struct Row {
    scene: &'static str,
    setup: Setup,
    frequency_hz: f32,
    steps: u32,
    is_complete: bool,
    steps_per_s: f64,
    deepest_m: f32,
    /// The share of contacts that were known again.
    kept: Option<f64>,
    rest: Option<Rest>,
    finding: Finding,
}

/// The number a scene is about.
pub(crate) struct Finding {
    /// What it is, with its unit.
    pub(crate) what: &'static str,
    /// `None` if it could not be measured.
    pub(crate) value: Option<f64>,
    /// Digits after the point.
    pub(crate) digits: usize,
    /// Whether all is as it should be.
    pub(crate) is_good: bool,
}

/// The columns of `behaviour.csv`.
pub(crate) const COLUMNS: &str = "scene,algorithm,contact_recycling,start,frequency_hz,steps,complete,steps_per_s,\
     deepest_mm,kept_percent,drift_mm,speed_mm_s,energy_mj,deepest_at_end_mm,what,value,passed";

impl Row {
    /// Of a scene that was played.
    pub(crate) fn new(
        scene: &'static str,
        stage: &Stage,
        rest: Option<Rest>,
        finding: Finding,
    ) -> Self {
        Self {
            scene,
            setup: stage.setup,
            frequency_hz: stage.frequency_hz(),
            steps: stage.steps,
            is_complete: stage.is_complete,
            steps_per_s: stage.steps_per_s(),
            deepest_m: stage.deepest_m,
            kept: stage.kept.share(),
            rest,
            finding,
        }
    }

    /// Of a scene that was not over after a while: not even a step was made.
    pub(crate) fn unfinished(scene: &'static str, setup: Setup, what: &'static str) -> Self {
        Self {
            scene,
            setup,
            frequency_hz: 60.0,
            steps: 0,
            is_complete: false,
            steps_per_s: 0.0,
            deepest_m: 0.0,
            kept: None,
            rest: None,
            finding: Finding {
                what,
                value: None,
                digits: 0,
                is_good: false,
            },
        }
    }

    pub(crate) fn scene(&self) -> &'static str {
        self.scene
    }

    pub(crate) fn setup(&self) -> Setup {
        self.setup
    }

    pub(crate) fn what(&self) -> &'static str {
        self.finding.what
    }

    pub(crate) fn passed(&self) -> bool {
        self.is_complete && self.finding.is_good
    }

    pub(crate) fn csv(&self) -> String {
        let number = |value: Option<f64>| value.map_or(String::new(), |v| format!("{v:.6}"));
        let rest =
            |of: fn(&Rest) -> f32| number(self.rest.as_ref().map(|r| f64::from(of(r)) * 1e3));
        format!(
            "{},\"{}\",{},{},{:.0},{},{},{:.3},{:.4},{},{},{},{},{},\"{}\",{},{}",
            self.scene,
            self.setup.kind.name(),
            self.setup.recycling.name(),
            self.setup.start,
            self.frequency_hz,
            self.steps,
            self.is_complete,
            self.steps_per_s,
            self.deepest_m * 1e3,
            number(self.kept.map(|share| 100.0 * share)),
            rest(|r| r.drift_m),
            rest(|r| r.speed_m_s),
            rest(|r| r.energy_j),
            rest(|r| r.deepest_m),
            self.finding.what,
            number(self.finding.value),
            self.passed(),
        )
    }

    /// A line of the table of its scene.
    pub(crate) fn markdown(&self) -> String {
        let mut line = format!("| {} | ", self.setup.kind.name());
        match self.steps {
            0 => line += "| | ",
            _ => {
                let steps_per_s = speed(self.steps_per_s);
                let _ = write!(line, "{steps_per_s} | {:.2} | ", self.deepest_m * 1e3);
            }
        }
        match &self.rest {
            Some(rest) => {
                let [drift, speed, energy] = [rest.drift_m, rest.speed_m_s, rest.energy_j]
                    .map(|v| small(f64::from(v) * 1e3));
                let left = f64::from(rest.deepest_m) * 1e3;
                let _ = write!(line, "{left:.2} | {drift} | {speed} | {energy} | ");
            }
            None => line += "| | | | ",
        }
        let _ = write!(line, "{} | {} |", self.value(), self.verdict());
        line
    }

    /// The share of contacts that were known again, in %.
    pub(crate) fn kept(&self) -> String {
        let percent = self.kept.map(|share| format!("{:.1}", 100.0 * share));
        percent.unwrap_or_default()
    }

    /// The number the scene is about.
    fn value(&self) -> String {
        let digits = self.finding.digits;
        let value = self.finding.value;
        value.map_or(String::new(), |value| format!("{value:.digits$}"))
    }

    fn verdict(&self) -> String {
        match (self.is_complete, self.passed()) {
            (false, _) if self.steps == 0 => "not a step".into(),
            (false, _) if self.steps == 1 => "stopped after 1 step".into(),
            (false, _) => format!("stopped after {} steps", self.steps),
            (true, true) => "yes".into(),
            (true, false) => "**no**".into(),
        }
    }

    /// Number and verdict as a cell of the table of all scenes.
    pub(crate) fn cell(&self) -> String {
        match self.value() {
            value if value.is_empty() => self.verdict(),
            value => format!("{value}: {}", self.verdict()),
        }
    }
}

fn speed(steps_per_s: f64) -> String {
    match steps_per_s {
        s if s >= 100.0 => format!("{s:.0}"),
        s if s >= 1.0 => format!("{s:.1}"),
        s => format!("{s:.3}"),
    }
}

fn small(value: f64) -> String {
    match value {
        v if v >= 100.0 => format!("{v:.0}"),
        v if v >= 0.01 => format!("{v:.2}"),
        v if v > 0.0 => format!("{v:.0e}"),
        _ => "0".into(),
    }
}
