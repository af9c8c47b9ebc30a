//! The small tables of an experiment.

use std::collections::BTreeMap;

use polars::prelude::DataFrame;

/// Tables of an experiment by name.
pub(crate) type Tables = BTreeMap<String, DataFrame>;
