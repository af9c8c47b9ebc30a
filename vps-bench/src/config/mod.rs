//! Algorithms and models as TOML files describe them, and how such files are read and checked.
//! Settings of experiments are beside their kinds.

pub(crate) mod algorithms;
pub(crate) mod models;
pub(crate) mod toml_file;
pub(crate) mod validate;
