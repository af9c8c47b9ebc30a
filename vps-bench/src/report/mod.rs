//! Claims, their verdicts, and the report, all made from the small tables alone.

pub(crate) mod claims;
pub(crate) mod comparison;
pub(crate) mod document;
mod html;
mod markdown;
pub(crate) mod page;
pub(crate) mod results;
pub(crate) mod splice;
pub(crate) mod write;
