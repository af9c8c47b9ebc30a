//! What runs jobs: which of them, on which core, with which models and algorithms, timed how, and
//! what of each is kept.

pub(crate) mod affinity;
pub(crate) mod archive;
pub(crate) mod context;
pub(crate) mod environment;
pub(crate) mod job;
pub(crate) mod lock;
mod model_source;
pub(crate) mod model_store;
mod native_ball;
pub(crate) mod prepare;
pub(crate) mod run;
pub(crate) mod scratch;
pub(crate) mod summarize;
pub(crate) mod timed_dispatcher;
