//! What TOML files say of algorithms and models. Kinds of experiments have their settings beside
//! them.

pub(crate) mod algorithms;
pub(crate) mod models;
pub(crate) mod toml_file;
pub(crate) mod validate;
