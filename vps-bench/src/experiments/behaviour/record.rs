//! The quantities a scene leaves.

use serde::Serialize;

use super::stage::{Rest, Stage};

/// A quantity, its unit in its name. Without a value it could not be measured.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Row {
    quantity: &'static str,
    value: Option<f64>,
}

/// All quantities of a scene that was played.
#[derive(Clone, Debug, Default)]
pub(super) struct Record(Vec<Row>);

/// Whether a scene was played to its end: 1 or 0.
pub(super) const COMPLETE: &str = "complete";
/// Steps made.
pub(super) const STEPS: &str = "steps";

impl Record {
    /// The quantities every scene has.
    pub(super) fn of(stage: &Stage<'_>) -> Self {
        Self::default()
            .with("frequency_hz", f64::from(stage.frequency_hz()))
            .with(STEPS, f64::from(stage.steps))
            .with(COMPLETE, f64::from(u8::from(stage.is_complete)))
            .with("steps_per_s", stage.steps_per_s())
            .with("deepest_mm", 1e3 * f64::from(stage.deepest_m))
            .with("warm_started_percent", stage.persistence.percent())
    }

    /// Of a scene in which no step ended in time.
    pub(super) fn unfinished() -> Self {
        Self::default().with(STEPS, 0.0).with(COMPLETE, 0.0)
    }

    /// Adds a quantity.
    pub(super) fn with(mut self, quantity: &'static str, value: impl Into<Option<f64>>) -> Self {
        let value = value.into().filter(|v| v.is_finite());
        self.0.push(Row { quantity, value });
        self
    }

    /// Adds how still bodies were that should be at rest.
    pub(super) fn with_rest(self, rest: Option<Rest>) -> Self {
        let milli = |of: fn(&Rest) -> f32| rest.as_ref().map(|r| 1e3 * f64::from(of(r)));
        self.with("drift_mm", milli(|r| r.drift_m))
            .with("speed_mm_s", milli(|r| r.speed_m_s))
            .with("energy_mj", milli(|r| r.energy_j))
            .with("deepest_at_end_mm", milli(|r| r.deepest_m))
    }

    pub(super) fn rows(&self) -> &[Row] {
        &self.0
    }
}
