//! The kinds of experiments, a folder each. A kind has settings in TOML, expands them to jobs, runs
//! one job to rows, summarizes rows in tables, and presents the tables in the report.

pub(crate) mod accuracy;
pub(crate) mod behaviour;
pub(crate) mod bounce;
pub(crate) mod builder;
pub(crate) mod drop;
pub(crate) mod experiment;
pub(crate) mod haptics;
pub(crate) mod queries;
pub(crate) mod query_profile;
pub(crate) mod registry;
pub(crate) mod replay;
pub(crate) mod scaling;
mod shared;
pub(crate) mod stack;
pub(crate) mod structures;
pub(crate) mod time_critical;
