//! Queries: a pointshell posed in a distance field.

pub(crate) mod approach;
mod body_pair;
pub(crate) mod collectors;
pub(crate) mod contact;
mod contacts;
mod manifold;
pub(crate) mod observer;
pub(crate) mod posed;
mod refinement;
mod search;
mod segments;
mod sweep;
mod time_critical;
mod work;

pub use self::approach::Approach;
pub use self::body_pair::{Body, BodyPair, PairContact, Shells, Side};
pub use self::contact::Contact;
pub use self::manifold::ContactManifold;
pub use self::observer::{DropReason, Event, Fate, Observer, Score};
pub use self::posed::Query;
pub use self::sweep::{Impact, Sweep};
pub use self::time_critical::Estimate;
pub use self::work::Work;
