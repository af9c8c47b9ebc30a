//! The subcommands, one file each.

pub(crate) mod build;
pub(crate) mod export;
pub(crate) mod inspect;
pub(crate) mod sample;

/// A message of one line.
pub(crate) type Error = Box<dyn std::error::Error>;
