//! What the command can do, a file each.

pub(crate) mod build;
pub(crate) mod export;
pub(crate) mod inspect;
pub(crate) mod sample;

/// One line for people.
pub(crate) type Error = Box<dyn std::error::Error>;
