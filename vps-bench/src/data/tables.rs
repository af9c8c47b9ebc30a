//! The small tables of an experiment.

use std::collections::BTreeMap;

use polars::prelude::DataFrame;

/// Tables of an experiment by name.
pub(crate) type Tables = BTreeMap<String, DataFrame>;

/// The table of a name, or an error that names it.
pub(crate) fn table<'t>(tables: &'t Tables, name: &str) -> Result<&'t DataFrame, String> {
    tables.get(name).ok_or_else(|| format!("no table `{name}`"))
}
