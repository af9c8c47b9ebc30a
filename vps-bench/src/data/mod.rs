//! Dataframes, statistics, checksums, and numbers as text.

pub(crate) mod checksum;
pub(crate) mod dataframe;
pub(crate) mod number_format;
pub(crate) mod stats;
pub(crate) mod tables;
