//! Runs jobs: their identifiers and shards, models and prepared algorithms, timing and affinity,
//! and the records they leave.

pub(crate) mod affinity;
pub(crate) mod archive;
pub(crate) mod context;
pub(crate) mod environment;
pub(crate) mod job;
pub(crate) mod lock;
mod model_source;
pub(crate) mod model_store;
pub(crate) mod prepare;
pub(crate) mod run;
pub(crate) mod scratch;
pub(crate) mod summarize;
pub(crate) mod timed_dispatcher;
