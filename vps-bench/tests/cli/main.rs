//! The command as its users meet it: small runs of a box that falls, and everything that can be
//! wrong.

mod behaviour;
mod builder;
mod compare;
mod fetch;
mod haptics;
mod messages;
mod project;
mod queries;
mod report;
mod resume;
mod run;
mod shards;
mod wrong;
