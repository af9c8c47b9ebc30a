//! The error of everything that ends a command.

/// One line for people.
pub(crate) type Error = Box<dyn std::error::Error>;
